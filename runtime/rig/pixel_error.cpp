#include "runtime/rig/pixel_error.h"

#include <algorithm>
#include <cmath>

namespace roomcal::rig {

namespace {

constexpr int kGrid = 5;

double largest_semi_axis(const Mat22& cov) {
  const double half_trace = 0.5 * (cov(0, 0) + cov(1, 1)), half_gap = 0.5 * (cov(0, 0) - cov(1, 1));
  return std::sqrt(std::max(0.0, half_trace + std::hypot(half_gap, cov(0, 1))));
}

}  // namespace

double predicted_pixel_error(const camera::Camera& camera, const SE3& T_cam_b, const Mat66& cov_cam_b,
                             double distance_m) {
  const camera::Intrinsics& k = camera.intrinsics();
  double worst_px = 0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const Vec2 px((0.5 + i % kGrid) * k.width_px / kGrid, (0.5 + i / kGrid) * k.height_px / kGrid);
    Vec3 bearing_cam;
    if (!camera.unproject(px, bearing_cam).ok()) continue;
    const Vec3 p_cam = distance_m * bearing_cam;
    Vec2 again_px;
    camera::ProjectJacobians J;
    if (!camera.project(p_cam, again_px, &J).ok()) continue;
    Eigen::Matrix<double, 2, 6> J_xi;
    J_xi.leftCols<3>() = J.J_point * T_cam_b.R;
    J_xi.rightCols<3>() = -J_xi.leftCols<3>() * hat(T_cam_b.inverse() * p_cam);
    worst_px = std::max(worst_px, largest_semi_axis(J_xi * cov_cam_b * J_xi.transpose()));
  }
  return worst_px;
}

}  // namespace roomcal::rig
