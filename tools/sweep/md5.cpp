#include "tools/sweep/md5.h"

#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include <fmt/core.h>

namespace roomcal::tools {

namespace {

constexpr std::array<int, 16> kShifts = {7, 12, 17, 22, 5, 9, 14, 20, 4, 11, 16, 23, 6, 10, 15, 21};

using State = std::array<uint32_t, 4>;

/// RFC 1321, section 3.4: round function and the word that it takes, by step.
uint32_t mix(int step, uint32_t b, uint32_t c, uint32_t d) {
  switch (step / 16) {
    case 0:
      return (b & c) | (~b & d);
    case 1:
      return (d & b) | (~d & c);
    case 2:
      return b ^ c ^ d;
    default:
      return c ^ (b | ~d);
  }
}

std::size_t word_of(int step) {
  constexpr std::array<int, 4> kFactor = {1, 5, 3, 7}, kOffset = {0, 1, 5, 0};
  const auto round = static_cast<std::size_t>(step / 16);
  return static_cast<std::size_t>((kFactor[round] * step + kOffset[round]) % 16);
}

void add_block(lidar::Bytes block, State& state) {
  auto [a, b, c, d] = state;
  for (int step = 0; step < 64; ++step) {
    const auto sine = static_cast<uint32_t>(std::floor(0x1p32 * std::abs(std::sin(step + 1.0))));
    const uint32_t sum = a + mix(step, b, c, d) + sine + lidar::le32(block, 4 * word_of(step));
    const uint32_t next = b + std::rotl(sum, kShifts[static_cast<std::size_t>(step / 16 * 4 + step % 4)]);
    a = d;
    d = c;
    c = b;
    b = next;
  }
  state[0] += a;
  state[1] += b;
  state[2] += c;
  state[3] += d;
}

}  // namespace

std::string md5_hex(lidar::Bytes bytes) {
  State state = {0x67452301, 0xEFCDAB89, 0x98BADCFE, 0x10325476};
  std::vector<std::byte> padded(bytes.begin(), bytes.end());
  padded.push_back(std::byte{0x80});
  while (padded.size() % 64 != 56) padded.push_back(std::byte{0});
  for (int i = 0; i < 8; ++i) padded.push_back(static_cast<std::byte>(uint64_t{8} * bytes.size() >> (8 * i)));
  for (std::size_t at = 0; at < padded.size(); at += 64) add_block(lidar::Bytes(padded).subspan(at, 64), state);
  std::string hex;
  for (const uint32_t word : state)
    for (int i = 0; i < 4; ++i) hex += fmt::format("{:02x}", word >> (8 * i) & 0xFF);
  return hex;
}

}  // namespace roomcal::tools
