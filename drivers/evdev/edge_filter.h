#pragma once

#include "runtime/ports/button.h"

namespace roomcal::drivers {

/// Makes the edges of one button from readings of its state, as ports::Button promises: none before a button that was
/// held at the start has been released, and none without a change.
class EdgeFilter {
 public:
  void start(bool held) {
    down_ = false;
    held_since_start_ = held;
  }

  /// @return true if `edge` is one to hand over.
  bool take(bool down, int64_t stamp_ns, ports::ButtonEdge& edge) {
    if (held_since_start_ && down) return false;
    held_since_start_ = false;
    if (down == down_) return false;
    down_ = down;
    edge = {down, stamp_ns};
    return true;
  }

 private:
  bool down_ = false;
  bool held_since_start_ = false;
};

}  // namespace roomcal::drivers
