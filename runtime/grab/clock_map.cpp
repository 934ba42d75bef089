#include "runtime/grab/clock_map.h"

#include <algorithm>
#include <cstdlib>

namespace roomcal::grab {

namespace {

/// A disciplined clock is slewed by 0.5 ms a second at most; what changes by more between two images was set.
constexpr int64_t kStep_ns = 1'000'000;
/// A device's clock and queue jitter by milliseconds; a jump beyond this is a restart of its clock.
constexpr int64_t kDeviceJump_ns = 500'000'000;
constexpr uint32_t kWindow = 64;

struct HostReading {
  int64_t offset_ns = 0;  ///< clock minus monotonic
  int64_t slack_ns = 0;   ///< half of what passed between the two monotonic readings
};

HostReading read_around(ClockId clock, const ports::SystemClocks& clocks) {
  const int64_t before_ns = clocks.now_ns();
  const int64_t there_ns = clocks.read(clock).ns;
  const int64_t after_ns = clocks.now_ns();
  return {there_ns - before_ns - (after_ns - before_ns) / 2, (after_ns - before_ns + 1) / 2};
}

}  // namespace

ImageTime ClockMap::by_offset(const Stamp& stamp, int64_t uncertainty_ns, int64_t offset_ns, int64_t slack_ns) {
  const int64_t changed_ns = has_offset_ ? std::abs(offset_ns - offset_ns_) : 0;
  if (changed_ns > kStep_ns) {
    ++steps_;
    uncertainty_ns += changed_ns;
  }
  offset_ns_ = offset_ns;
  has_offset_ = true;
  return {stamp.ns - offset_ns, uncertainty_ns + slack_ns};
}

ImageTime ClockMap::by_arrival(const Stamp& stamp, int64_t uncertainty_ns, int64_t arrived_ns) {
  const int64_t delay_ns = arrived_ns - stamp.ns;  // offset of the clocks plus what the image took
  const bool jumped =
      windows_ + in_window_ > 0 && std::abs(delay_ns - std::min(least_ns_, least_before_ns_)) > kDeviceJump_ns;
  if (jumped) ++steps_;
  if (jumped || windows_ + in_window_ == 0) {
    least_ns_ = least_before_ns_ = most_ns_ = delay_ns;
    windows_ = in_window_ = 0;
  }
  least_ns_ = std::min(least_ns_, delay_ns);
  most_ns_ = std::max(most_ns_, delay_ns);
  const int64_t offset_ns = -std::min(least_ns_, least_before_ns_);
  const int64_t spread_ns = most_ns_ + offset_ns;
  if (++in_window_ == kWindow) {
    least_before_ns_ = least_ns_;
    least_ns_ = most_ns_ = delay_ns;
    in_window_ = 0;
    ++windows_;
  }
  // The least delay still contains what the quickest image took: nothing tells how long that is.
  return {stamp.ns - offset_ns, uncertainty_ns + spread_ns + (jumped ? latency_ns_ : 0)};
}

ImageTime ClockMap::to_monotonic(const Stamp& stamp, int64_t uncertainty_ns, int64_t arrived_ns,
                                 const ports::SystemClocks& clocks) {
  if (stamp.clock != clock_) {
    *this = ClockMap(latency_ns_);
    clock_ = stamp.clock;
  }
  switch (stamp.clock) {
    case ClockId::kMonotonic:
      return {stamp.ns, uncertainty_ns};
    case ClockId::kRealtime:
    case ClockId::kBoottime:
    case ClockId::kTai: {
      const HostReading host = read_around(stamp.clock, clocks);
      return by_offset(stamp, uncertainty_ns, host.offset_ns, host.slack_ns);
    }
    case ClockId::kDevice:
      return by_arrival(stamp, uncertainty_ns, arrived_ns);
    case ClockId::kUnknown:
      break;
  }
  return {arrived_ns - latency_ns_ / 2, latency_ns_ / 2};
}

}  // namespace roomcal::grab
