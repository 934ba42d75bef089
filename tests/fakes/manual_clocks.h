#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>

#include "runtime/ports/system_clocks.h"

namespace roomcal::fakes {

/// Clocks that a test winds. Sleeping winds them too.
class ManualClocks final : public ports::SystemClocks {
 public:
  int64_t now_ns() const override { return now_ns_; }
  Stamp read(ClockId clock) const override {
    if (clock == ClockId::kMonotonic) return {now_ns_, clock};
    if (clock == ClockId::kRealtime) return {now_ns_ + realtime_ahead_ns_, clock};
    return {0, clock};
  }
  void sleep_until(int64_t deadline_ns) const override {
    ++sleeps_;
    now_ns_ = std::max(now_ns_, deadline_ns);
    if (on_sleep) on_sleep(now_ns_);
  }

  /// What the world does while somebody sleeps.
  std::function<void(int64_t now_ns)> on_sleep;

  void advance(int64_t by_ns) { now_ns_ += by_ns; }
  /// Somebody sets the realtime clock.
  void step_realtime(int64_t by_ns) { realtime_ahead_ns_ += by_ns; }
  int sleeps() const { return sleeps_; }

 private:
  mutable int64_t now_ns_ = 1'000'000'000;
  int64_t realtime_ahead_ns_ = 1'700'000'000'000'000'000;
  mutable int sleeps_ = 0;
};

}  // namespace roomcal::fakes
