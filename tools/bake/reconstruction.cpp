#include "tools/bake/reconstruction.h"

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace roomcal::tools {

std::size_t Reconstruction::alive_count() const {
  return static_cast<std::size_t>(std::count(alive.begin(), alive.end(), true));
}

std::vector<std::vector<PointSight>> collect_sights(const Reconstruction& map) {
  std::vector<std::vector<PointSight>> sights(map.points.size());
  for (std::size_t v = 0; v < map.views.size(); ++v) {
    if (!map.views[v].placed) continue;
    for (const Side side : kBothSides) {
      const std::vector<int>& point = map.views[v].point[side];
      for (std::size_t s = 0; s < point.size(); ++s) {
        if (point[s] != kNoPoint) sights[static_cast<std::size_t>(point[s])].push_back({v, side, s});
      }
    }
  }
  return sights;
}

std::size_t count_views(const std::vector<PointSight>& sights) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < sights.size(); ++i) count += i == 0 || sights[i].view != sights[i - 1].view;
  return count;
}

Reconstruction start_reconstruction(const StereoRig& rig, const Survey& survey) {
  Reconstruction map;
  map.rig = rig;
  map.views.resize(survey.views.size());
  for (std::size_t v = 0; v < map.views.size(); ++v) {
    for (const Side side : kBothSides) map.views[v].point[side].assign(survey.views[v].seen[side].size(), kNoPoint);
  }
  return map;
}

void unplace(Reconstruction& map, std::size_t view) {
  ViewState& state = map.views[view];
  for (std::vector<int>& point : state.point) std::fill(point.begin(), point.end(), kNoPoint);
  state.placed = false;
  std::erase(map.order, view);
}

namespace {

bool has(const std::vector<int>& point, std::size_t p) {
  return std::find(point.begin(), point.end(), static_cast<int>(p)) != point.end();
}

void rename(std::vector<int>& point, std::size_t from, int to) {
  std::replace(point.begin(), point.end(), static_cast<int>(from), to);
}

}  // namespace

bool join_points(Reconstruction& map, std::size_t kept, std::size_t gone) {
  for (const ViewState& view : map.views) {
    for (const std::vector<int>& point : view.point) {
      if (has(point, kept) && has(point, gone)) return false;
    }
  }
  merge_points(map, kept, gone);
  return true;
}

void merge_points(Reconstruction& map, std::size_t kept, std::size_t gone) {
  for (ViewState& view : map.views) {
    for (std::vector<int>& point : view.point) {
      rename(point, gone, has(point, kept) ? kNoPoint : static_cast<int>(kept));
    }
  }
  map.alive[gone] = false;
}

void remove_point(Reconstruction& map, std::size_t gone) {
  for (ViewState& view : map.views) {
    for (std::vector<int>& point : view.point) rename(point, gone, kNoPoint);
  }
  map.alive[gone] = false;
}

bool retriangulate(const Survey& survey, const Reconstruction& map, const std::vector<PointSight>& sights,
                   double sigma_px, SpacePoint& point) {
  Vec3 p_room = point.p;
  Mat33 information;
  for (int round = 0; round < 4; ++round) {
    information.setZero();
    Vec3 gradient = Vec3::Zero();
    for (const PointSight& sight : sights) {
      const SE3& T_room_left = map.views[sight.view].T_room_left;
      const Vec3 p_cam = map.rig.in_camera(sight.side, T_room_left.inverse() * p_room);
      camera::ProjectJacobians jacobians;
      Vec2 px;
      if (!map.rig.cameras[sight.side].project(p_cam, px, &jacobians).ok()) continue;
      const Vec2 residual_px = px - survey.views[sight.view].seen[sight.side][sight.sighting].centre_px;
      Mat33 R_cam_room = T_room_left.R.transpose();
      if (sight.side == kRight) R_cam_room = map.rig.T_right_left.R * R_cam_room;
      const Mat23 J = jacobians.J_point * R_cam_room;
      // Cauchy's weight: one wrong measurement must not drag the point.
      const double weight = 1 / (1 + residual_px.squaredNorm() / (9 * sigma_px * sigma_px));
      information += weight * J.transpose() * J;
      gradient += weight * J.transpose() * residual_px;
    }
    const Eigen::LDLT<Mat33> solver(information);
    if (solver.info() != Eigen::Success || solver.rcond() < 1e-10) return false;
    p_room -= solver.solve(gradient);
  }
  if (!p_room.allFinite()) return false;
  point = {p_room, sigma_px * sigma_px * information.inverse()};
  return true;
}

}  // namespace roomcal::tools
