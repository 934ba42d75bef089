#include "runtime/camera/parameters.h"

#include <cmath>

namespace roomcal::camera {

namespace {

constexpr double kUsualFocal = 0.002, kUsualPrincipal_px = 1.0, kUsualDistortion_px = 0.5;

using ByParameters = Eigen::Matrix<double, 2, kIntrinsicsCount>;

/// Derivatives in the image's far corner, or where the field ends on the way there.
ByParameters derivatives_in_corner(const Camera& camera) {
  const Intrinsics& k = camera.intrinsics();
  const Vec2 corner_px(k.cx_px < 0.5 * k.width_px ? k.width_px - 0.5 : -0.5,
                       k.cy_px < 0.5 * k.height_px ? k.height_px - 0.5 : -0.5);
  Vec3 bearing_cam;
  if (!camera.unproject(corner_px, bearing_cam).ok()) {
    const Vec2 e = (corner_px - Vec2(k.cx_px, k.cy_px)).normalized();
    const double angle_rad = 0.999 * camera.max_angle_rad();
    bearing_cam << std::sin(angle_rad) * e, std::cos(angle_rad);
  }
  Vec2 px;
  ProjectJacobians J;
  if (!camera.project(bearing_cam, px, &J).ok()) return ByParameters::Zero();
  return J.J_intrinsics;
}

}  // namespace

Parameters parameters_of(const Intrinsics& intrinsics) {
  Parameters out;
  out << intrinsics.fx_px, intrinsics.fy_px, intrinsics.cx_px, intrinsics.cy_px, intrinsics.distortion[0],
      intrinsics.distortion[1], intrinsics.distortion[2], intrinsics.distortion[3];
  return out;
}

Intrinsics with_parameters(const Intrinsics& intrinsics, const Parameters& parameters) {
  Intrinsics out = intrinsics;
  out.fx_px = parameters[0];
  out.fy_px = parameters[1];
  out.cx_px = parameters[2];
  out.cy_px = parameters[3];
  for (int i = 0; i < kDistortionCount; ++i) out.distortion[static_cast<std::size_t>(i)] = parameters[4 + i];
  return out;
}

IntrinsicsSigma usual_sigma(const Intrinsics& intrinsics) {
  return {kUsualFocal * 0.5 * (intrinsics.fx_px + intrinsics.fy_px), kUsualPrincipal_px, kUsualDistortion_px};
}

Parameters parameter_sigmas(const Camera& camera, const IntrinsicsSigma& sigma) {
  Parameters out;
  out << sigma.focal_px, sigma.focal_px, sigma.principal_px, sigma.principal_px, 0, 0, 0, 0;
  if (sigma.distortion_px <= 0) return out;
  const ByParameters J = derivatives_in_corner(camera);
  for (int i = 4; i < kIntrinsicsCount; ++i)
    if (const double px = J.col(i).norm(); px > 0) out[i] = sigma.distortion_px / px;
  return out;
}

Mat22 pixel_covariance(const Camera& camera, const Parameters& sigma, const Vec2& px) {
  Vec3 bearing_cam;
  Vec2 again_px;
  ProjectJacobians J;
  if (!camera.unproject(px, bearing_cam).ok() || !camera.project(bearing_cam, again_px, &J).ok()) return Mat22::Zero();
  const ByParameters scaled = J.J_intrinsics * sigma.asDiagonal();
  return scaled * scaled.transpose();
}

}  // namespace roomcal::camera
