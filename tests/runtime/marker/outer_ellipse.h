#pragma once

#include <cmath>

#include <Eigen/LU>

#include "runtime/marker/detector.h"

namespace roomcal::marker {

/// The outer circle's image from the homography: H^-T diag(1, 1, -1) H^-1.
inline Ellipse outer_ellipse(const Mat33& H_px_plane) {
  const Mat33 H_plane_px = H_px_plane.inverse();
  const Mat33 Q = H_plane_px.transpose() * Vec3{1, 1, -1}.asDiagonal() * H_plane_px;
  Mat22 M = Q.topLeftCorner<2, 2>();
  Ellipse ellipse;
  ellipse.centre_px = -M.inverse() * Q.topRightCorner<2, 1>();
  M /= -(Q(2, 2) + Q.topRightCorner<2, 1>().dot(ellipse.centre_px));
  const double trace = M.trace(), spread = std::hypot(M(0, 0) - M(1, 1), 2 * M(0, 1));
  ellipse.major_px = 2 / std::sqrt((trace - spread) / 2);
  ellipse.minor_px = 2 / std::sqrt((trace + spread) / 2);
  ellipse.angle_rad = 0.5 * std::atan2(-2 * M(0, 1), M(1, 1) - M(0, 0));
  return ellipse;
}

}  // namespace roomcal::marker
