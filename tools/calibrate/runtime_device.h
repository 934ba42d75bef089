#pragma once

#include <string>

#include "runtime/calib/device.h"
#include "tools/device/device.h"

namespace roomcal::tools {

/// The sensors of a device as the runtime wants them: fixed capacities, camera models checked.
/// @param source  where the device came from, for messages.
/// @throws ToolError for more cameras or LiDARs than the runtime has room for, a LiDAR model that is not known, no
/// camera, or a reference sensor that is not a camera.
calib::Device to_runtime(const Device& device, const std::string& source);

}  // namespace roomcal::tools
