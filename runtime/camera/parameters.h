#pragma once

#include <array>

#include "runtime/camera/camera.h"
#include "runtime/camera/intrinsics.h"
#include "runtime/math/types.h"

namespace roomcal::camera {

/// The parameters of a camera as a vector: fx fy cx cy d0 d1 d2 d3.
using Parameters = Eigen::Matrix<double, kIntrinsicsCount, 1>;
using ParameterMatrix = Eigen::Matrix<double, kIntrinsicsCount, kIntrinsicsCount>;

/// Names of the parameters as files have them; distortion as d0 to d3, whatever the model calls them.
inline constexpr std::array<const char*, kIntrinsicsCount> kParameterNames = {"fx_px", "fy_px", "cx_px", "cy_px",
                                                                              "d0",    "d1",    "d2",    "d3"};

Parameters parameters_of(const Intrinsics& intrinsics);
/// The same camera with other parameters.
Intrinsics with_parameters(const Intrinsics& intrinsics, const Parameters& parameters);

/// How far the parameters of a calibrated camera may be off, 1-sigma, independent of each other; 0: exact.
struct IntrinsicsSigma {
  double focal_px = 0;       ///< of fx and of fy
  double principal_px = 0;   ///< of cx and of cy
  double distortion_px = 0;  ///< by which each distortion coefficient may displace a point in the image's corner
};

/// What a calibration with a board leaves after some months and degrees: 0.2 % of the focal length, a pixel of the
/// principal point, half a pixel in the corner for every coefficient.
IntrinsicsSigma usual_sigma(const Intrinsics& intrinsics);

/// Sigma of every parameter. A corner outside the lens' valid field counts at the field's edge.
Parameters parameter_sigmas(const Camera& camera, const IntrinsicsSigma& sigma);

/// Covariance of where a point appears, because of the parameters: J diag(sigma^2) J^T at the ray that px belongs to;
/// zero where there is none.
Mat22 pixel_covariance(const Camera& camera, const Parameters& sigma, const Vec2& px);

}  // namespace roomcal::camera
