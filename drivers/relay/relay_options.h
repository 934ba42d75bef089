#pragma once

#include <cstdint>

#include "drivers/image/recovery.h"

namespace roomcal::drivers {

struct RelayOptions {
  RecoveryOptions recovery;
  /// A library may need seconds to find out that nobody answers: Aravis up to 7.5 s for a camera that has died.
  int64_t start_wait_ns = 20'000'000'000;
  int64_t stop_wait_ns = 20'000'000'000;
  int64_t hang_ns = 20'000'000'000;  ///< a call that takes longer is told and counts as kFaulted until it returns
};

}  // namespace roomcal::drivers
