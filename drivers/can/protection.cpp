#include "drivers/can/protection.h"

#include <array>

namespace roomcal::drivers {

namespace {

constexpr uint8_t kPolynomial = 0x1D;
constexpr Signal kCrc{"Crc", 0, 8, false, 1, 0, 0, 255, "", {}};
constexpr Signal kCounter{"Counter", 8, 4, false, 1, 0, 0, kCounterSteps - 1, "", {}};

constexpr std::array<uint8_t, 256> make_table() {
  std::array<uint8_t, 256> table{};
  for (unsigned i = 0; i < table.size(); ++i) {
    unsigned crc = i;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x80) != 0 ? (crc << 1) ^ kPolynomial : crc << 1;
    table[i] = static_cast<uint8_t>(crc);
  }
  return table;
}
constexpr std::array<uint8_t, 256> kTable = make_table();

uint8_t checksum(const MessageLayout& layout, const ports::CanMessage& message) {
  const std::array<uint8_t, 2> id{static_cast<uint8_t>(layout.data_id), static_cast<uint8_t>(layout.data_id >> 8)};
  return crc8(std::span<const uint8_t>(message.data).subspan(1, layout.length - 1U), crc8(id));
}

}  // namespace

uint8_t crc8(std::span<const uint8_t> bytes, uint8_t before) {
  for (const uint8_t byte : bytes) before = kTable[before ^ byte];
  return before;
}

void protect(const MessageLayout& layout, uint8_t counter, ports::CanMessage& message) {
  put_raw(kCounter, counter, message);
  put_raw(kCrc, checksum(layout, message), message);
}

Protection check_protection(const MessageLayout& layout, const ports::CanMessage& message) {
  if (message.length != layout.length) return Protection::kOtherLength;
  if (raw_of(kCrc, message) != checksum(layout, message)) return Protection::kBadChecksum;
  return counter_of(message) < kCounterSteps ? Protection::kGood : Protection::kBadCounter;
}

uint8_t counter_of(const ports::CanMessage& message) { return static_cast<uint8_t>(raw_of(kCounter, message)); }

}  // namespace roomcal::drivers
