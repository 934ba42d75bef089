#pragma once

#include <compare>
#include <cstdint>

namespace roomcal {

/// Which clock a stamp was read from. Stamps of different clocks do not compare.
enum class ClockId : uint8_t {
  kUnknown,
  kMonotonic,
  kRealtime,  ///< UTC, and may be set
  kBoottime,  ///< monotonic, and runs while the machine sleeps
  kTai,       ///< atomic time, 37 s ahead of UTC since 2017
  kDevice,    ///< of the sensor itself, with an epoch of its own
};
/// "monotonic", "realtime", ...
const char* to_string(ClockId clock);

/// A point in time: nanoseconds of a named clock.
struct Stamp {
  int64_t ns = 0;
  ClockId clock = ClockId::kUnknown;

  friend bool operator==(const Stamp&, const Stamp&) = default;
};

/// @return true if the difference of the stamps means something: same clock, and the clock is known.
constexpr bool comparable(const Stamp& a, const Stamp& b) { return a.clock == b.clock && a.clock != ClockId::kUnknown; }

}  // namespace roomcal
