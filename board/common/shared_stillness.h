#pragma once

#include <cstdint>

#include "runtime/base/latest.h"
#include "runtime/ports/stillness_sensor.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::board {

/// What the supervisor saw last of a sensor of motion, for the session's thread. What is too old is motion: a
/// supervisor that hangs proves nothing.
class SharedStillness final : public ports::StillnessSensor {
 public:
  static constexpr int64_t kStale_ns = 100'000'000;  // the supervisor looks every 10 ms

  explicit SharedStillness(const ports::SystemClocks& clocks) : clocks_(clocks) {}

  /// Supervisor.
  void tell(const ports::Stillness& seen) { latest_.set({seen, clocks_.now_ns()}); }
  /// Session.
  ports::Stillness look(int64_t now_ns) override {
    const Seen& seen = latest_.get();
    if (now_ns - seen.at_ns <= kStale_ns) return seen.stillness;
    return {false, "motion: nobody is looking at its sensors: see `health`"};
  }

 private:
  struct Seen {
    ports::Stillness stillness;
    int64_t at_ns = 0;
  };
  const ports::SystemClocks& clocks_;
  Latest<Seen> latest_;
};

}  // namespace roomcal::board
