#pragma once

#include <array>

#include "runtime/camera/camera.h"
#include "runtime/math/se3.h"

namespace roomcal::rig {

/// Distances at which the pixel error of an extrinsic is told, m.
inline constexpr std::array<double, 4> kPixelErrorDistances_m = {1, 2, 5, 10};

/// How far off points of another sensor may appear in a camera, 1-sigma, because of their extrinsic alone.
///
/// For points on a 5 x 5 grid of the image at `distance_m` from the camera,
///     cov_px = J_project R [I, -hat(p_b)] cov_cam_b [..]^T R^T J_project^T,
/// the largest semi-axis over the grid. Grid points outside the lens' valid field are passed over.
/// @param cov_cam_b  of T_cam_b, right perturbation (frame b).
/// @return px; 0 if the whole grid is outside.
double predicted_pixel_error(const camera::Camera& camera, const SE3& T_cam_b, const Mat66& cov_cam_b,
                             double distance_m);

}  // namespace roomcal::rig
