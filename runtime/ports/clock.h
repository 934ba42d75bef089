#pragma once

#include <cstdint>

namespace roomcal::ports {

/// Monotonic time for stage timing and time-outs. The runtime makes no OS call; the board brings the clock.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual int64_t now_ns() const = 0;
};

}  // namespace roomcal::ports
