#pragma once

#include <cstdint>

#include "drivers/image/health_log.h"
#include "drivers/v4l2/handle.h"
#include "drivers/v4l2/options.h"
#include "drivers/v4l2/settings_guard.h"

namespace roomcal::drivers {

/// What the camera does after apply_settings().
struct Timing {
  int64_t period_ns = 0;    ///< between images; 0: unknown
  int64_t exposure_ns = 0;  ///< 0: unknown
};

/// Rate, exposure, gain and trigger as the options say. What the camera refuses is noted in `log` and does not hinder,
/// but for the trigger: a camera that ignores it would show another moment than the others.
/// @return kFormat if the trigger cannot be set; kGone.
Trouble apply_settings(const V4l2Handle& handle, bool multiplanar, const V4l2Options& options, SettingsGuard& guard,
                       HealthLog& log, Timing& timing);

}  // namespace roomcal::drivers
