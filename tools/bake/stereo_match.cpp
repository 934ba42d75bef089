#include "tools/bake/stereo_match.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace roomcal::tools {

namespace {

using Vec4d = Eigen::Matrix<double, 4, 1>;
using Mat43 = Eigen::Matrix<double, 4, 3>;

class StereoMatcher {
 public:
  StereoMatcher(const StereoRig& rig, const StereoView& view, const StereoMatchOptions& options)
      : rig_(rig), view_(view), options_(options) {
    for (const Side side : kBothSides) {
      for (const Sighting& sighting : view.seen[side]) {
        Vec3 bearing = Vec3::Zero();  // stays so outside the lens' field: never matched
        static_cast<void>(rig.cameras[side].unproject(sighting.centre_px, bearing).ok());
        bearings_[side].push_back(bearing);
      }
    }
  }

  std::vector<StereoPoint> run() const {
    std::vector<StereoPoint> points;
    for (std::size_t i = 0; i < bearings_[kLeft].size(); ++i) {
      for (std::size_t j = 0; j < bearings_[kRight].size(); ++j) {
        StereoPoint point{i, j, {}, {}, 0, false};
        if (on_epipolar_line(i, j) && alike(i, j) && triangulate(point)) points.push_back(point);
      }
    }
    mark_ambiguous(points);
    return points;
  }

 private:
  static void mark_ambiguous(std::vector<StereoPoint>& points) {
    for (StereoPoint& point : points) {
      point.ambiguous = std::any_of(points.begin(), points.end(), [&](const StereoPoint& other) {
        return &other != &point && (other.left == point.left || other.right == point.right);
      });
    }
  }

  /// Angle of the right bearing out of the plane through the baseline and the left bearing.
  bool on_epipolar_line(std::size_t i, std::size_t j) const {
    const Vec3 normal = rig_.T_right_left.t.cross(rig_.T_right_left.R * bearings_[kLeft][i]);
    const double length = normal.norm();
    if (length < 1e-9 || bearings_[kRight][j].isZero()) return false;
    const double off_rad = std::abs(normal.dot(bearings_[kRight][j])) / length;
    // Both ends are noisy; the exact test follows on the triangulated point.
    return off_rad * rig_.cameras[kRight].intrinsics().fx_px < 2 * options_.gate_sigmas * options_.sigma_px;
  }

  bool alike(std::size_t i, std::size_t j) const {
    const auto& left = view_.seen[kLeft][i].ellipse;
    const auto& right = view_.seen[kRight][j].ellipse;
    if (!left || !right) return true;
    const double ratio = left->major_px / rig_.cameras[kLeft].intrinsics().fx_px /
                         (right->major_px / rig_.cameras[kRight].intrinsics().fx_px);
    return ratio < options_.max_size_ratio && ratio > 1 / options_.max_size_ratio;
  }

  bool triangulate(StereoPoint& point) const {
    if (!start(point)) return false;
    Mat33 information;
    for (int round = 0; round < 4; ++round) {
      Vec4d residual;
      Mat43 J;
      if (!residuals(point, residual, J)) return false;
      point.residual_px = residual.norm();
      information = J.transpose() * J;
      point.p_left -= information.ldlt().solve(J.transpose() * residual);
    }
    const double range_m = point.p_left.norm();
    if (!(range_m > options_.min_range_m && range_m < options_.max_range_m)) return false;
    point.cov_m2 = options_.sigma_px * options_.sigma_px * information.inverse();
    // The four residuals leave one degree of freedom: the distance from the epipolar line.
    return point.cov_m2.allFinite() && point.residual_px < options_.gate_sigmas * options_.sigma_px;
  }

  /// Where the two rays pass each other, on the left one.
  bool start(StereoPoint& point) const {
    const Mat33 R_left_right = rig_.T_right_left.R.transpose();
    const Vec3 a = bearings_[kLeft][point.left];
    const Vec3 b = R_left_right * bearings_[kRight][point.right];
    const Vec3 base = -(R_left_right * rig_.T_right_left.t);
    const double ab = a.dot(b), sin2 = 1 - ab * ab;
    if (sin2 < 1e-12) return false;
    const double range_left = (base.dot(a) - ab * base.dot(b)) / sin2;
    const double range_right = (ab * base.dot(a) - base.dot(b)) / sin2;
    if (range_left <= 0 || range_right <= 0) return false;
    point.p_left = a * std::min(range_left, options_.max_range_m);
    return true;
  }

  bool residuals(const StereoPoint& point, Vec4d& residual, Mat43& J) const {
    const std::array<std::size_t, 2> index{point.left, point.right};
    for (const Side side : kBothSides) {
      const auto row = static_cast<Eigen::Index>(2 * side);
      camera::ProjectJacobians jacobians;
      Vec2 px;
      if (!rig_.cameras[side].project(rig_.in_camera(side, point.p_left), px, &jacobians).ok()) return false;
      residual.segment<2>(row) = px - view_.seen[side][index[side]].centre_px;
      J.middleRows<2>(row) = side == kLeft ? jacobians.J_point : Mat23(jacobians.J_point * rig_.T_right_left.R);
    }
    return true;
  }

  const StereoRig& rig_;
  const StereoView& view_;
  const StereoMatchOptions& options_;
  std::array<std::vector<Vec3>, 2> bearings_;
};

}  // namespace

std::vector<StereoPoint> match_stereo(const StereoRig& rig, const StereoView& view, const StereoMatchOptions& options) {
  return StereoMatcher(rig, view, options).run();
}

double epipolar_sigma_px(const std::vector<std::vector<StereoPoint>>& stereo) {
  std::vector<double> residuals_px;
  for (const std::vector<StereoPoint>& points : stereo) {
    for (const StereoPoint& point : points) {
      if (!point.ambiguous) residuals_px.push_back(point.residual_px);
    }
  }
  if (residuals_px.empty()) return 0;
  const auto middle = residuals_px.begin() + static_cast<std::ptrdiff_t>(residuals_px.size() / 2);
  std::nth_element(residuals_px.begin(), middle, residuals_px.end());
  return *middle / 0.6745;
}

}  // namespace roomcal::tools
