#pragma once

#include "runtime/camera/camera.h"
#include "tools/map/anchor_room_file.h"

namespace roomcal::tools {

/// A calibrated stereo pair, fitted to the key-frames of an anchor room.
struct StereoPair {
  camera::Intrinsics left;
  camera::Intrinsics right;
  SE3 T_right_left;
  double median_left_px = 0;  ///< length of the residual, with the file's map and the refined poses
  double median_right_px = 0;
};

/// Intrinsics of both cameras (fx fy cx cy; the file's key points are undistorted) and one T_right_left for all frames.
///
/// Robust Levenberg-Marquardt on the reprojection of all frames at once, the file's map and correspondences given, its
/// poses as start; every frame's pose is refined too, because the file's are rounded to what its authors' own
/// intrinsics made of them. Poses are eliminated frame by frame (Schur complement).
/// @throws ToolError if the fit does not converge (too few key points with a map point).
/// Cost: linear in the key points; a second for 20,000.
StereoPair fit_stereo_pair(const AnchorRoom& room);

}  // namespace roomcal::tools
