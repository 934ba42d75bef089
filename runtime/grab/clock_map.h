#pragma once

#include <cstdint>

#include "runtime/base/status.h"
#include "runtime/base/time.h"
#include "runtime/grab/image_ring.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::grab {

/// Brings the stamps of one source to the host's monotonic clock.
///
/// | stamp's clock       | how                                                                              |
/// |---------------------|----------------------------------------------------------------------------------|
/// | monotonic           | as it is                                                                         |
/// | realtime, boottime, | the host has that clock: both are read around each other at every stamp          |
/// | tai                 | (a step of the clock shows as a change of the offset)                            |
/// | device              | only arrivals relate it: the smallest arrival minus stamp of the last 64 is the  |
/// |                     | offset, their spread the uncertainty; drift is followed, a jump starts anew      |
/// | unknown             | the arrival, and as uncertainty the time that an image may take                  |
///
/// A stamp that was taken across a step of its clock carries the step as its uncertainty: whoever groups by stamps then
/// sees that it means nothing. Not thread-safe: one map a source.
class ClockMap {
 public:
  /// @param latency_ns  how long an image may take from exposure to arrival, where nothing better is known.
  explicit ClockMap(int64_t latency_ns = 100'000'000) : latency_ns_(latency_ns) {}

  /// @param stamp  of the source. @param arrived_ns  monotonic, when the host had it; not before the exposure.
  /// Cost: three readings of a clock at most.
  ImageTime to_monotonic(const Stamp& stamp, int64_t uncertainty_ns, int64_t arrived_ns,
                         const ports::SystemClocks& clocks);

  /// Steps of the clock that were noticed.
  uint32_t steps() const { return steps_; }

 private:
  ImageTime by_offset(const Stamp& stamp, int64_t uncertainty_ns, int64_t offset_ns, int64_t slack_ns);
  ImageTime by_arrival(const Stamp& stamp, int64_t uncertainty_ns, int64_t arrived_ns);

  int64_t latency_ns_;
  ClockId clock_ = ClockId::kUnknown;
  bool has_offset_ = false;
  int64_t offset_ns_ = 0;  ///< of the source's clock over the monotonic one, as last used
  uint32_t steps_ = 0;
  // Of arrivals minus stamps, for a clock that the host cannot read: the least of this window and the one before.
  int64_t least_ns_ = 0, least_before_ns_ = 0, most_ns_ = 0;
  uint32_t in_window_ = 0, windows_ = 0;
};

}  // namespace roomcal::grab
