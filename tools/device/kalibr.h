#pragma once

#include <string>
#include <vector>

#include "tools/device/device.h"

namespace roomcal::tools {

/// Cameras of a Kalibr camchain, in its order. The first is the rig frame.
///
/// Understood: camera_model `pinhole` with distortion_model `radtan`, `equidistant` or `none`; intrinsics, resolution;
/// T_cn_cnm1 (maps points of the camera before to this one), which becomes the nominal mounting with the sigmas of
/// kChainSigma. Other keys (rostopic, cam_overlaps, T_cam_imu, ...) are passed over.
/// @throws ToolError "where:line: ..."; another model (omni, ds, eucm, fov) is "not supported".
Device parse_kalibr(const std::string& where, const std::string& text);

/// What a mounting from a camchain may be off: it was calibrated once, but the rig has travelled since.
inline constexpr double kChainSigma_t_m = 0.01;
inline constexpr double kChainSigma_rot_rad = kPi / 180;

}  // namespace roomcal::tools
