#include "tools/evaluate/baseline_bound.h"

#include <array>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace roomcal::tools {

namespace {

using Mat1212 = Eigen::Matrix<double, 12, 12>;
using Mat123 = Eigen::Matrix<double, 12, 3>;
using Vec12 = Eigen::Matrix<double, 12, 1>;

/// What the rings of one marker tell of both poses and of the marker.
struct MarkerInformation {
  Mat1212 poses = Mat1212::Zero();
  Mat123 cross = Mat123::Zero();
  Mat33 point = Mat33::Zero();
};

Mat33 cross_matrix(const Vec3& v) {
  Mat33 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

const SceneMarker* nearest_marker(const std::vector<SceneMarker>& markers, const TrueCamera& camera,
                                  const Vec2& centre_px) {
  constexpr double kSame_px = 1;
  const SceneMarker* nearest = nullptr;
  double nearest_px = kSame_px;
  for (const SceneMarker& marker : markers) {
    Vec2 px;
    if (!camera.camera.project(camera.T_room_cam.inverse() * marker.centre_room, px).ok()) continue;
    if (const double off_px = (px - centre_px).norm(); off_px < nearest_px) {
      nearest_px = off_px;
      nearest = &marker;
    }
  }
  return nearest;
}

/// T exp(xi) with xi = (rho, phi) moves a point in the camera's frame by -rho + [p] phi.
void add_ring(const TrueCamera& camera, std::size_t number, const marker::Detection& ring, const Vec3& p_room,
              MarkerInformation& information) {
  const Vec3 p_cam = camera.T_room_cam.inverse() * p_room;
  Vec2 px;
  camera::ProjectJacobians jacobians;
  if (!camera.camera.project(p_cam, px, &jacobians).ok()) return;
  Eigen::Matrix<double, 2, 12> J_poses = Eigen::Matrix<double, 2, 12>::Zero();
  const auto first = static_cast<Eigen::Index>(6 * number);
  J_poses.middleCols<3>(first) = -jacobians.J_point;
  J_poses.middleCols<3>(first + 3) = jacobians.J_point * cross_matrix(p_cam);
  const Mat23 J_point = jacobians.J_point * camera.T_room_cam.R.transpose();
  const Mat22 weight = ring.cov_px2.inverse();
  information.poses += J_poses.transpose() * weight * J_poses;
  information.cross += J_poses.transpose() * weight * J_point;
  information.point += J_point.transpose() * weight * J_point;
}

}  // namespace

double baseline_bound_m(const Scene& scene, const Stand& stand, std::span<const std::vector<marker::Detection>> rings,
                        double map_sigma_m) {
  const std::vector<SceneMarker> markers = markers_of(scene);
  std::map<int, MarkerInformation> seen;
  for (std::size_t camera = 0; camera < 2; ++camera)
    for (const marker::Detection& ring : rings[camera])
      if (const SceneMarker* marker = nearest_marker(markers, stand.cameras[camera], ring.centre_px))
        add_ring(stand.cameras[camera], camera, ring, marker->centre_room, seen[marker->id]);
  Mat1212 information = Mat1212::Zero();
  for (const auto& [id, of_marker] : seen) {
    information += of_marker.poses;
    if (map_sigma_m <= 0) continue;
    const Mat33 point = of_marker.point + Mat33::Identity() / (map_sigma_m * map_sigma_m);
    information -= of_marker.cross * point.inverse() * of_marker.cross.transpose();
  }
  const std::array<SE3, 2> T = {stand.cameras[0].T_room_cam, stand.cameras[1].T_room_cam};
  const Vec3 along = (T[1].t - T[0].t).normalized();
  Vec12 gradient = Vec12::Zero();  // of |t1 - t0|, with t' = t + R rho
  gradient.segment<3>(0) = -T[0].R.transpose() * along;
  gradient.segment<3>(6) = T[1].R.transpose() * along;
  return std::sqrt(gradient.dot(information.ldlt().solve(gradient)));
}

}  // namespace roomcal::tools
