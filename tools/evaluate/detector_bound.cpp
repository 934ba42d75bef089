#include "tools/evaluate/detector_bound.h"

#include <cmath>

#include <Eigen/LU>

namespace roomcal::tools {

namespace {

/// Order of the unknowns.
enum : int { kCentre = 0, kStretch = 2, kVanish = 5, kLight = 7, kInk = 10, kRadii = 11, kBlur = 16, kAll = 17 };
constexpr int kGeometryAndLight = kRadii;

using Unknowns = Eigen::Matrix<double, kAll, 1>;

/// A marker about its true centre: px = c + A (1 + S) q / (1 + w . q), q in radii.
class SmoothMarker {
 public:
  SmoothMarker(const FieldMarker& marker, const camera::Camera& camera, const FieldOptions& field, double blur_px)
      : field_(field), blur_px_(blur_px) {
    Vec2 px;
    camera::ProjectJacobians jacobians;
    static_cast<void>(camera.project(marker.centre_cam, px, &jacobians));  // the field has checked it
    Mat32 axes_cam;
    axes_cam << marker.axis_u_cam, marker.axis_v_cam;
    A_ = jacobians.J_point * axes_cam;
    w_ = axes_cam.row(2).transpose() / marker.centre_cam.z();
    centre_px_ = px;
  }

  const Vec2& centre_px() const { return centre_px_; }

  /// Grey level; unknowns are deviations from the truth. @param r  radius on the marker, for the caller's choice.
  double grey(const Vec2& point_px, const Unknowns& x, double* r = nullptr) const {
    const Vec2 d = point_px - centre_px_ - x.segment<2>(kCentre);
    Mat22 S;
    S << 1 + x[kStretch], x[kStretch + 1], x[kStretch + 1], 1 + x[kStretch + 2];
    const Vec2 w = w_ + x.segment<2>(kVanish);
    const Mat22 M_inverse = (A_ * S - d * w.transpose()).inverse();
    const Vec2 q = M_inverse * d;
    const double radius = q.norm();
    const Vec2 gradient = (M_inverse * (1 + w.dot(q))).transpose() * q / radius;  // of the radius, per px
    if (r != nullptr) *r = radius;
    const double light =
        1 + x[kLight] + (field_.gradient * uphill() + x.segment<2>(kLight + 1)).dot(d) / field_.diameter_px;
    const double ink = ink_share(radius, 1 / gradient.norm(), x);
    return light * (field_.paper_grey + (field_.ink_grey + x[kInk] - field_.paper_grey) * ink);
  }

 private:
  Vec2 uphill() const { return {std::cos(field_.gradient_azimuth_rad), std::sin(field_.gradient_azimuth_rad)}; }

  double ink_share(double radius, double px_per_radius, const Unknowns& x) const {
    const double blur = blur_px_ + x[kBlur];
    const double sigma = std::sqrt(2 * (blur * blur + 1.0 / 12));
    double share = 0, sign = 1;
    for (std::size_t k = 0; k < field_.ring_radii.size(); ++k) {
      const double edge = field_.ring_radii[k] + (k > 0 ? x[kRadii + static_cast<int>(k) - 1] : 0.0);
      share += sign * 0.5 * std::erfc((radius - edge) * px_per_radius / sigma);
      sign = -sign;
    }
    return share;
  }

  const FieldOptions& field_;
  double blur_px_;
  Mat22 A_ = Mat22::Zero();
  Vec2 w_ = Vec2::Zero();
  Vec2 centre_px_ = Vec2::Zero();
};

/// Steps of the differences: small beside the blur, large beside rounding.
Unknowns steps_of(double diameter_px) {
  constexpr double kStep_px = 1e-3;
  Unknowns steps = Unknowns::Constant(kStep_px / diameter_px);
  steps.segment<2>(kCentre).setConstant(kStep_px);
  steps[kInk] = 1e-2;
  steps[kBlur] = kStep_px;
  return steps;
}

Unknowns gradient_at(const SmoothMarker& marker, const Vec2& px, const Unknowns& steps) {
  Unknowns gradient;
  for (int i = 0; i < kAll; ++i) {
    Unknowns x = Unknowns::Zero();
    x[i] = steps[i];
    const double plus = marker.grey(px, x);
    x[i] = -steps[i];
    gradient[i] = (plus - marker.grey(px, x)) / (2 * steps[i]);
  }
  return gradient;
}

}  // namespace

CentreBound centre_bound(const FieldMarker& marker, const camera::Camera& camera, const FieldOptions& field,
                         double blur_px) {
  constexpr double kLargest_px = 120;  // larger markers are sampled: every n-th pixel counts n^2 times
  constexpr double kOuterRadius = 1.15;
  const SmoothMarker smooth(marker, camera, field, blur_px);
  const Unknowns steps = steps_of(field.diameter_px);
  const int stride = std::max(1, static_cast<int>(field.diameter_px / kLargest_px));
  const int reach = static_cast<int>(std::ceil(0.75 * field.diameter_px + 4));
  const Vec2 middle(std::round(smooth.centre_px().x()), std::round(smooth.centre_px().y()));
  Eigen::Matrix<double, kAll, kAll> information = Eigen::Matrix<double, kAll, kAll>::Zero();
  for (int y = -reach; y <= reach; y += stride) {
    for (int x = -reach; x <= reach; x += stride) {
      const Vec2 px = middle + Vec2(x, y);
      double radius = 0;
      static_cast<void>(smooth.grey(px, Unknowns::Zero(), &radius));
      if (radius > kOuterRadius + 3 * blur_px * 2 / field.diameter_px) continue;
      const Unknowns gradient = gradient_at(smooth, px, steps);
      information += gradient * gradient.transpose() * (stride * stride);
    }
  }
  const Eigen::Matrix<double, kGeometryAndLight, kGeometryAndLight> known_print =
      information.topLeftCorner<kGeometryAndLight, kGeometryAndLight>().inverse();
  const Eigen::Matrix<double, kAll, kAll> unknown_print = information.inverse();
  return {information.topLeftCorner<2, 2>().inverse(), known_print.topLeftCorner<2, 2>(),
          unknown_print.topLeftCorner<2, 2>()};
}

}  // namespace roomcal::tools
