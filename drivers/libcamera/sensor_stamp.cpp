#include "drivers/libcamera/sensor_stamp.h"

#include <algorithm>

namespace roomcal::drivers {

namespace {

constexpr int64_t kAheadNs = 1'000'000;
constexpr int64_t kOldNs = 1'000'000'000;
constexpr int64_t kNoSleepNs = 1'000'000;
constexpr int64_t kJitterNs = 1'000'000;  // of stamps that a driver works out from the bus's clock
constexpr int64_t kUnknownPeriodNs = 100'000'000;

bool is_of(int64_t stamp_ns, int64_t now_ns) { return now_ns - stamp_ns >= -kAheadNs && now_ns - stamp_ns <= kOldNs; }

}  // namespace

SensorStamp sensor_stamp(const SensorTimes& times, const ports::SystemClocks& clocks) {
  const int64_t monotonic_ns = clocks.now_ns();
  const int64_t boottime_ns = clocks.read(ClockId::kBoottime).ns;
  const int64_t slept_ns = std::max<int64_t>(boottime_ns - monotonic_ns, 0);
  const bool is_monotonic = is_of(times.stamp_ns, monotonic_ns), is_boottime = is_of(times.stamp_ns, boottime_ns);
  const int64_t longest_ns = times.exposure_ns > 0 ? times.exposure_ns
                             : times.period_ns > 0 ? times.period_ns
                                                   : kUnknownPeriodNs;
  SensorStamp result;
  result.exposed.ns = times.stamp_ns - longest_ns / 2;
  result.uncertainty_ns = longest_ns / 2 + kJitterNs;
  if (is_monotonic && (slept_ns < kNoSleepNs || !is_boottime)) {
    result.exposed.clock = ClockId::kMonotonic;
  } else if (is_boottime) {
    result.exposed.clock = ClockId::kBoottime;
    if (is_monotonic) result.uncertainty_ns += slept_ns;
  }
  return result;
}

}  // namespace roomcal::drivers
