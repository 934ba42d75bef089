#pragma once

#include "runtime/calib/device.h"
#include "runtime/calib/limits.h"
#include "runtime/calib/outcome.h"

namespace roomcal::calib {

/// Sets verdict and reasons of an outcome whose cameras and solution are filled. Every reason is one line that names
/// the sensor and what to do.
/// Cost: linear in the cameras, no allocation.
void judge(const Device& device, const Limits& limits, Outcome& outcome);

}  // namespace roomcal::calib
