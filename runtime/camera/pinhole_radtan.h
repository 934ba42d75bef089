#pragma once

#include "runtime/camera/intrinsics.h"
#include "runtime/math/types.h"

namespace roomcal::camera {

/// Radial-tangential distortion of the normalized plane, with m = (x, y) / z and q = (p2, p1):
///     m_d = (1 + k1 |m|^2 + k2 |m|^4) m + 2 (q . m) m + |m|^2 q
/// Source: Brown, "Close-range camera calibration", 1971, in OpenCV's order k1 k2 p1 p2. Its Jacobian is symmetric, so
/// the map is the gradient of a potential: where the Jacobian is positive definite on a disc, it is one-to-one there.
struct PinholeRadtan {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0;

  static PinholeRadtan from(const Intrinsics& intrinsics);

  /// @param[out] J  d m_d / d m; may be null.
  Vec2 distort(const Vec2& m, Mat22* J = nullptr) const;

  /// m_d in the four distortion parameters: d m_d / d (k1 k2 p1 p2).
  static Eigen::Matrix<double, 2, kDistortionCount> parameter_jacobian(const Vec2& m);

  /// Radius of the disc |m| <= limit on which the Jacobian's eigenvalues stay above kMinSlope.
  /// @param max_distorted_radius  the disc ends earlier where the radial part reaches this.
  double max_radius(double max_distorted_radius) const;

  /// Inverse of distort() within |m| <= max_radius.
  /// @param[out] m  untouched unless true.
  /// @return false if no point of the disc maps to m_d. Cost: Newton, at most 30 rounds radially and 30 in the plane.
  bool undistort(const Vec2& m_d, double max_radius, Vec2& m) const;
};

}  // namespace roomcal::camera
