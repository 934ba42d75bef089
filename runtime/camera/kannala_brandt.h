#pragma once

#include <array>

#include "runtime/camera/intrinsics.h"
#include "runtime/camera/radial_newton.h"

namespace roomcal::camera {

/// Fisheye with radius r(theta) = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8) in the normalized
/// plane. Source: Kannala, Brandt, "A generic camera model and calibration method", PAMI 2006, eq. (6), as in Kalibr
/// and OpenCV.
struct KannalaBrandt {
  std::array<double, kDistortionCount> k{};

  static KannalaBrandt from(const Intrinsics& intrinsics) { return {intrinsics.distortion}; }

  /// r and d r / d theta.
  ValueAndSlope radius(double theta_rad) const;

  /// Largest angle up to which the slope stays above kMinSlope, at most just below pi.
  /// @param max_distorted_radius  the field ends earlier where r reaches this.
  double max_angle_rad(double max_distorted_radius) const;

  /// Inverse of radius() within max_angle_rad. @return a negative number if r lies beyond.
  double angle_rad(double r, double max_angle_rad) const;
};

}  // namespace roomcal::camera
