#pragma once

#include <cstdint>

#include "runtime/base/fixed_text.h"

namespace roomcal::ports {

/// Whether the device stands still. Any doubt is `still == false`.
struct Stillness {
  bool still = false;
  Reason why;  ///< one line that names source and remedy; empty if still
};

/// Something that knows whether the device moves: the vehicle's own standstill message, an IMU.
class StillnessSensor {
 public:
  virtual ~StillnessSensor() = default;
  /// What is known at `now_ns` (monotonic); does not wait.
  virtual Stillness look(int64_t now_ns) = 0;
};

}  // namespace roomcal::ports
