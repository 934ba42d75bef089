#pragma once

#include <chrono>

#include "runtime/ports/clock.h"

namespace roomcal::tools {

/// The host's monotonic clock behind the runtime's port.
class SteadyClock final : public ports::Clock {
 public:
  int64_t now_ns() const override {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }
};

}  // namespace roomcal::tools
