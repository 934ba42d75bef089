#pragma once

#include <cstdint>
#include <span>

#include "drivers/can/signal.h"

namespace roomcal::drivers {

/// What the protection of a message says about it.
enum class Protection : uint8_t {
  kGood,
  kOtherLength,  ///< not as long as its layout
  kBadChecksum,
  kBadCounter,  ///< 15, which nobody sends
};

/// Counters run from 0 to 14.
inline constexpr uint8_t kCounterSteps = 15;
constexpr uint8_t counter_after(uint8_t counter) { return static_cast<uint8_t>((counter + 1) % kCounterSteps); }

/// CRC-8 with polynomial 0x1D (SAE J1850), start value and final xor 0, most significant bit first.
/// Check value: of the nine characters "123456789" it is 0x37.
/// @param before  result for the bytes that came before.
uint8_t crc8(std::span<const uint8_t> bytes, uint8_t before = 0);

/// AUTOSAR E2E profile 11, variant 11A (data identifier in the checksum only): counter into bits 8 to 11, then the
/// checksum over low and high byte of the data identifier and all bytes behind the checksum into byte 0.
/// Source: AUTOSAR FO PRS E2E Protocol, "Specification of E2E Profile 11".
/// @pre layout.data_id is not 0.
void protect(const MessageLayout& layout, uint8_t counter, ports::CanMessage& message);

/// Looks at length, counter and checksum. Whether the counter goes on from the message before is the receiver's to ask.
Protection check_protection(const MessageLayout& layout, const ports::CanMessage& message);
uint8_t counter_of(const ports::CanMessage& message);

}  // namespace roomcal::drivers
