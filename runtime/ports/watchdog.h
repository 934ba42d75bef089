#pragma once

namespace roomcal::ports {

/// Restarts the device unless it is fed: the board feeds it only while every thread has answered.
class Watchdog {
 public:
  virtual ~Watchdog() = default;
  virtual void feed() = 0;
};

}  // namespace roomcal::ports
