#include "tools/bake/resection.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace roomcal::tools {

namespace {

/// A point's image with the uncertainty that the point brings along.
struct Image {
  Vec2 px = Vec2::Zero();
  Mat22 cov_px2 = Mat22::Zero();
  Mat26 J_pose = Mat26::Zero();  ///< d px / d xi, T_room_left = T_hat exp(xi)
};

bool image_of(const Reconstruction& map, std::size_t point, Side side, const SE3& T_room_left, Image& image) {
  const Vec3 p_left = T_room_left.R.transpose() * (map.points[point].p - T_room_left.t);
  camera::ProjectJacobians jacobians;
  if (!map.rig.cameras[side].project(map.rig.in_camera(side, p_left), image.px, &jacobians).ok()) return false;
  const Mat23 J_left = side == kLeft ? jacobians.J_point : Mat23(jacobians.J_point * map.rig.T_right_left.R);
  const Mat23 J_room = J_left * T_room_left.R.transpose();
  image.cov_px2 = J_room * map.points[point].cov_m2 * J_room.transpose();
  image.J_pose << -J_left, J_left * hat(p_left);
  return true;
}

void assign_side(const Survey& survey, Reconstruction& map, std::size_t view, Side side, double sigma_px,
                 double spread_px) {
  struct Candidate {
    double chi2;
    std::size_t sighting, point;
  };
  constexpr double kMaxChi2 = 14;  // 2 degrees of freedom: 99.9 %
  const std::vector<Sighting>& seen = survey.views[view].seen[side];
  ViewState& state = map.views[view];
  std::vector<Candidate> candidates;
  const double own_px2 = sigma_px * sigma_px + spread_px * spread_px;
  for (std::size_t p = 0; p < map.points.size(); ++p) {
    Image image;
    if (!map.alive[p] || !image_of(map, p, side, state.T_room_left, image)) continue;
    if (!map.rig.in_image(side, image.px, -0.5 * map.rig.cameras[side].intrinsics().width_px)) continue;
    const Mat22 cov_px2 = image.cov_px2 + own_px2 * Mat22::Identity();
    const Mat22 information = cov_px2.inverse();
    for (std::size_t s = 0; s < seen.size(); ++s) {
      const Vec2 off_px = seen[s].centre_px - image.px;
      const double chi2 = off_px.dot(information * off_px);
      if (chi2 < kMaxChi2) candidates.push_back({chi2, s, p});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.chi2 < b.chi2; });
  std::vector<int>& point = state.point[side];
  std::fill(point.begin(), point.end(), kNoPoint);
  std::set<std::size_t> used;
  for (const Candidate& candidate : candidates) {
    if (point[candidate.sighting] != kNoPoint || !used.insert(candidate.point).second) continue;
    point[candidate.sighting] = static_cast<int>(candidate.point);
  }
}

}  // namespace

void assign_points(const Survey& survey, Reconstruction& map, std::size_t view, double sigma_px, double spread_px) {
  for (const Side side : kBothSides) assign_side(survey, map, view, side, sigma_px, spread_px);
}

bool resect(const Survey& survey, Reconstruction& map, std::size_t view, double sigma_px) {
  ViewState& state = map.views[view];
  SE3 T_room_left = state.T_room_left;
  for (int round = 0; round < 10; ++round) {
    Mat66 H = Mat66::Zero();
    Vec6 g = Vec6::Zero();
    std::size_t used = 0;
    for (const Side side : kBothSides) {
      for (std::size_t s = 0; s < state.point[side].size(); ++s) {
        Image image;
        const int p = state.point[side][s];
        if (p == kNoPoint || !image_of(map, static_cast<std::size_t>(p), side, T_room_left, image)) continue;
        const Vec2 residual_px = image.px - survey.views[view].seen[side][s].centre_px;
        const Mat22 information = (image.cov_px2 + sigma_px * sigma_px * Mat22::Identity()).inverse();
        const double weight = 1 / (1 + residual_px.dot(information * residual_px) / 9);
        H += weight * image.J_pose.transpose() * information * image.J_pose;
        g += weight * image.J_pose.transpose() * information * residual_px;
        ++used;
      }
    }
    if (used < 3) return false;
    const Vec6 step = -H.ldlt().solve(g);
    if (!step.allFinite() || step.norm() > 5) return false;
    T_room_left = T_room_left * se3_exp(step);
    if (step.norm() < 1e-8) break;
  }
  state.T_room_left = T_room_left;
  return true;
}

ViewFit judge_view(const Survey& survey, const Reconstruction& map, std::size_t view) {
  const ViewState& state = map.views[view];
  ViewFit fit;
  double sum_px2 = 0;
  std::set<int> left(state.point[kLeft].begin(), state.point[kLeft].end());
  for (const Side side : kBothSides) {
    for (std::size_t s = 0; s < state.point[side].size(); ++s) {
      const int p = state.point[side][s];
      Image image;
      if (p == kNoPoint || !image_of(map, static_cast<std::size_t>(p), side, state.T_room_left, image)) continue;
      sum_px2 += (image.px - survey.views[view].seen[side][s].centre_px).squaredNorm();
      ++fit.sightings;
      fit.in_both += side == kRight && left.contains(p);
    }
  }
  if (fit.sightings > 0) fit.rms_px = std::sqrt(sum_px2 / static_cast<double>(fit.sightings));
  const double margin_px = 0.06 * map.rig.cameras[kLeft].intrinsics().width_px;
  for (std::size_t p = 0; p < map.points.size(); ++p) {
    Image image;
    if (!map.alive[p] || !image_of(map, p, kLeft, state.T_room_left, image)) continue;
    if (!map.rig.in_image(kLeft, image.px, margin_px)) continue;
    ++fit.expected;
    fit.met += left.contains(static_cast<int>(p));
  }
  return fit;
}

}  // namespace roomcal::tools
