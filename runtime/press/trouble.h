#pragma once

#include "runtime/calib/outcome.h"
#include "runtime/press/state.h"

namespace roomcal::press {

/// Where the operator should look first for an outcome that may not be written; kNone for one that may.
Trouble trouble_of(const calib::Outcome& outcome);

}  // namespace roomcal::press
