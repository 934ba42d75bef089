#include "runtime/base/crc32c.h"

#include <array>
#include <string_view>

#include <gtest/gtest.h>

namespace roomcal {
namespace {

uint32_t crc_of(std::string_view text, uint32_t before = 0) {
  return crc32c(std::as_bytes(std::span<const char>(text.data(), text.size())), before);
}

TEST(Crc32c, StandardCheckString_GivesCheckValue) { EXPECT_EQ(crc_of("123456789"), 0xE3069283U); }

TEST(Crc32c, NoBytes_GivesZero) { EXPECT_EQ(crc_of(""), 0U); }

// RFC 3720, B.4.
TEST(Crc32c, IscsiVectors_Match) {
  std::array<std::byte, 32> bytes{};
  EXPECT_EQ(crc32c(bytes), 0x8A9136AAU);
  bytes.fill(std::byte{0xFF});
  EXPECT_EQ(crc32c(bytes), 0x62A8AB43U);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i);
  EXPECT_EQ(crc32c(bytes), 0x46DD794EU);
}

TEST(Crc32c, InTwoParts_EqualsWhole) { EXPECT_EQ(crc_of("56789", crc_of("1234")), crc_of("123456789")); }

TEST(Crc32c, AnyBitFlipped_Differs) {
  std::array<std::byte, 24> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(7 * i + 3);
  const uint32_t whole = crc32c(bytes);
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= std::byte{1} << (bit % 8);
    EXPECT_NE(crc32c(bytes), whole) << bit;
    bytes[bit / 8] ^= std::byte{1} << (bit % 8);
  }
}

}  // namespace
}  // namespace roomcal
