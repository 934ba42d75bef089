#pragma once

#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

/// The clocks of Linux. Any thread; no state.
class LinuxClocks final : public ports::SystemClocks {
 public:
  int64_t now_ns() const override;
  Stamp read(ClockId clock) const override;
  /// Signals do not shorten it.
  void sleep_until(int64_t deadline_ns) const override;
};

}  // namespace roomcal::drivers
