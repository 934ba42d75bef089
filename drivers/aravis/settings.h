#pragma once

#include "drivers/aravis/aravis_options.h"
#include "drivers/aravis/features.h"
#include "drivers/image/health_log.h"
#include "drivers/relay/library_camera.h"

namespace roomcal::drivers {

/// Brings a camera to what the options want, by way of `features`, so that all of it can be undone. The stream must not
/// run. What a camera cannot do exactly (an exposure beyond its range) is done as well as it can, and noted; what
/// matters is refused.
/// @return kFormat for a pixel format, size, trigger or packet size that it does not have, named in the log.
LibraryResult apply_settings(const AravisOptions& options, Features& features, HealthLog& log);

/// Exposure time in force, in ns; `otherwise` if the camera does not tell.
int64_t exposure_ns(const Features& features, int64_t otherwise);

}  // namespace roomcal::drivers
