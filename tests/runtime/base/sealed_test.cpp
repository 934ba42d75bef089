#include "runtime/base/sealed.h"

#include <cstring>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal {
namespace {

constexpr SealedKind kKind = {
    .magic = {'a', 'b', 'c', 'd', 'e', 'f', 'g', '\n'},
    .version = 3,
    .max_bytes = 200,
    .too_short = "too short",
    .absent = "absent",
    .header_damaged = "header damaged",
    .other_version = "other version",
    .cut_short = "cut short",
    .damaged = "damaged",
};

class Sealed : public testing::Test {
 protected:
  Sealed() {
    const SealedHeader header = seal(payload_, kKind);
    bytes_.resize((sizeof header + payload_.size() + 7) / 8);
    std::memcpy(bytes_.data(), &header, sizeof header);
    std::memcpy(span().data() + sizeof header, payload_.data(), payload_.size());
  }
  std::span<std::byte> span() { return std::as_writable_bytes(std::span(bytes_)); }

  std::vector<std::byte> payload_ = std::vector<std::byte>(40, std::byte{7});
  std::vector<uint64_t> bytes_;
};

TEST_F(Sealed, WhatWasSealed_Opens) {
  const auto opened = open_sealed(span(), kKind);
  ASSERT_TRUE(opened.ok()) << opened.status().detail();
  EXPECT_EQ(opened.value().size(), payload_.size());
  EXPECT_EQ(sealed_size(span(), kKind).value(), 64U);
}

TEST_F(Sealed, EveryFlippedBit_IsFound) {
  for (std::size_t i = 0; i < 64; ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      span()[i] ^= static_cast<std::byte>(1 << bit);
      EXPECT_FALSE(open_sealed(span(), kKind).ok()) << "byte " << i;
      span()[i] ^= static_cast<std::byte>(1 << bit);
    }
  }
}

TEST_F(Sealed, EveryCut_IsFound) {
  for (std::size_t size = 0; size < 64; ++size) EXPECT_FALSE(open_sealed(span().first(size), kKind).ok()) << size;
  EXPECT_STREQ(open_sealed(span().first(10), kKind).status().detail(), "too short");
  EXPECT_STREQ(open_sealed(span().first(50), kKind).status().detail(), "cut short");
}

TEST_F(Sealed, OfAnotherKindOrVersion_IsNamed) {
  SealedKind other = kKind;
  other.magic[0] = 'x';
  EXPECT_STREQ(open_sealed(span(), other).status().detail(), "absent");
  other = kKind;
  other.version = 4;
  EXPECT_EQ(open_sealed(span(), other).status().code(), StatusCode::kUnsupported);
  EXPECT_STREQ(sealed_size(span(), other).status().detail(), "other version");
}

TEST_F(Sealed, LargerThanItsKindAllows_IsDamage) {
  SealedKind small = kKind;
  small.max_bytes = 60;
  EXPECT_STREQ(open_sealed(span(), small).status().detail(), "header damaged");
}

TEST_F(Sealed, AskewBytes_AreTheCallersError) {
  EXPECT_EQ(open_sealed(span().subspan(1), kKind).status().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace roomcal
