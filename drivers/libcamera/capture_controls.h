#pragma once

#include <libcamera/controls.h>

#include "drivers/image/health_log.h"
#include "drivers/libcamera/libcamera_options.h"

namespace roomcal::drivers {

/// Whether this libcamera can synchronize cameras at all.
bool can_synchronize();

/// What the options ask of a camera, as far as it has it; what it does not have is noted.
/// @param available  Camera::controls().
libcamera::ControlList capture_controls(const LibcameraOptions& options, const libcamera::ControlInfoMap& available,
                                        HealthLog& log);

/// Whether a camera that synchronizes says that it is in step. False where this libcamera cannot.
bool in_step(const libcamera::ControlList& metadata);

}  // namespace roomcal::drivers
