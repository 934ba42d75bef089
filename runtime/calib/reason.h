#pragma once

#include "runtime/base/fixed_text.h"
#include "runtime/base/status.h"

namespace roomcal::calib {

/// printf into a fixed text; what does not fit is cut. No allocation for the conversions that we use (%s %d %zu %.Nf).
[[gnu::format(printf, 1, 2)]] Reason make_reason(const char* format, ...);

/// "<sensor>: <code>: <detail>", for a status that a sensor ran into.
Reason sensor_reason(const SensorName& name, const Status& status);

}  // namespace roomcal::calib
