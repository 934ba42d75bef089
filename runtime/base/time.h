#pragma once

#include <compare>
#include <cstdint>

namespace roomcal {

/// Which clock a stamp was read from. Stamps of different clocks do not compare.
enum class ClockId : uint8_t { kUnknown, kMonotonic, kRealtime, kTai, kDevice };

/// A point in time: nanoseconds of a named clock.
struct Stamp {
  int64_t ns = 0;
  ClockId clock = ClockId::kUnknown;

  friend bool operator==(const Stamp&, const Stamp&) = default;
};

/// @return true if the difference of the stamps means something: same clock, and the clock is known.
constexpr bool comparable(const Stamp& a, const Stamp& b) { return a.clock == b.clock && a.clock != ClockId::kUnknown; }

}  // namespace roomcal
