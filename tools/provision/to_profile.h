#pragma once

#include <filesystem>

#include "runtime/profile/profile.h"
#include "tools/device/device.h"

namespace roomcal::tools {

/// The device as its program wants it: intrinsics, mountings, LiDAR angles, wiring, limits.
/// @param file  device.yaml, for messages; calibration files are looked for beside it.
/// @throws ToolError naming sensor and remedy for what profile::check_profile() refuses, more sensors than the runtime
///         has room for, a reference that is no camera, a LiDAR without the angles that its model needs.
profile::Profile to_profile(const Device& device, const std::filesystem::path& file);

}  // namespace roomcal::tools
