#pragma once

#include <cstdint>

#include "runtime/base/time.h"
#include "runtime/ports/clock.h"

namespace roomcal::ports {

/// The host's clocks, and waiting. now_ns() is the monotonic one.
class SystemClocks : public Clock {
 public:
  /// Reads a clock: kMonotonic, kRealtime, kBoottime or kTai; 0 for one that the host does not have.
  virtual Stamp read(ClockId clock) const = 0;
  /// Returns at `deadline_ns` (monotonic), or a little later; at once if it is past.
  virtual void sleep_until(int64_t deadline_ns) const = 0;
};

}  // namespace roomcal::ports
