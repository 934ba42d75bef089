#include "runtime/marker/ring_model.h"

#include <cmath>

#include <Eigen/LU>

namespace roomcal::marker {
namespace {

Mat22 shape_of(const RingModel& model) {
  Mat22 W;
  W << model[kShape00], 0, model[kShape10], model[kShape11];
  return W;
}

}  // namespace

double RingModel::contrast() const {
  const double light = value[kLight0] + value[kLightX] * value[kCentreX] + value[kLightY] * value[kCentreY];
  return light * (1 - value[kInk]);
}

RingModel model_from_ellipse(const Ellipse& ellipse, const Vec2& shift) {
  RingModel model;
  // A whole-pixel origin keeps the pixels' float coordinates exact.
  model.origin_px = {std::round(ellipse.centre_px.x()), std::round(ellipse.centre_px.y())};
  model.scale_px = ellipse.major_px / 2;
  const double cosine = std::cos(ellipse.angle_rad), sine = std::sin(ellipse.angle_rad);
  const double ratio = ellipse.major_px / ellipse.minor_px;
  // From units of the semi-major axis to the ellipse's frame, where it is the unit circle.
  Mat22 B;
  B << cosine, sine, -ratio * sine, ratio * cosine;
  // The inverse of the homography of PolarGrid, about its own centre: W_z d / (1 + h_z . d).
  const double rest = 1 - shift.squaredNorm();
  const Mat22 M_z = (rest * Mat22::Identity() + shift * shift.transpose()) / (rest * rest);
  const Vec2 h = B.transpose() * (-shift / rest);
  const Mat22 M = B.transpose() * M_z * B;  // W^T W
  model[kShape11] = std::sqrt(M(1, 1));
  model[kShape10] = M(0, 1) / model[kShape11];
  model[kShape00] = std::sqrt(M(0, 0) - model[kShape10] * model[kShape10]);
  model[kLineX] = h.x();
  model[kLineY] = h.y();
  const Vec2 centre = (ellipse.centre_px - model.origin_px) / model.scale_px + B.inverse() * shift;
  model[kCentreX] = centre.x();
  model[kCentreY] = centre.y();
  return model;
}

bool ellipse_of_radius(const RingModel& model, double radius, Ellipse& ellipse) {
  // |W d|^2 = radius^2 (1 + h.d)^2  <=>  (d - d0)^T Q (d - d0) = k,  Q = W^T W - radius^2 h h^T, Q d0 = radius^2 h.
  const Mat22 W = shape_of(model);
  const Vec2 h{model[kLineX], model[kLineY]};
  const double square = radius * radius;
  const Mat22 Q = W.transpose() * W - square * h * h.transpose();
  const double determinant = Q(0, 0) * Q(1, 1) - Q(0, 1) * Q(1, 0);
  const double trace = Q(0, 0) + Q(1, 1);
  if (!(determinant > 0) || !(trace > 0)) return false;
  Mat22 Q_inverse;
  Q_inverse << Q(1, 1), -Q(0, 1), -Q(1, 0), Q(0, 0);
  Q_inverse /= determinant;
  const Vec2 offset = square * (Q_inverse * h);
  const double k = square + h.dot(offset) * square;
  const double spread = std::hypot(Q(0, 0) - Q(1, 1), 2 * Q(0, 1));
  const double small = (trace - spread) / 2, large = (trace + spread) / 2;
  if (!(small > 0) || !(k > 0)) return false;
  ellipse.centre_px = model.centre_px() + model.scale_px * offset;
  ellipse.major_px = 2 * model.scale_px * std::sqrt(k / small);
  ellipse.minor_px = 2 * model.scale_px * std::sqrt(k / large);
  // Eigenvector of the small eigenvalue: the large one's turned by 90 degrees.
  ellipse.angle_rad = 0.5 * std::atan2(-2 * Q(0, 1), Q(1, 1) - Q(0, 0));
  return true;
}

double radius_at(const RingModel& model, const Vec2& point_px) {
  const Vec2 d = (point_px - model.centre_px()) / model.scale_px;
  const Vec2 u = shape_of(model) * d;
  return u.norm() / (1 + model[kLineX] * d.x() + model[kLineY] * d.y());
}

bool is_plausible(const RingModel& model) {
  for (int i = 0; i < model.parameters(); ++i) {
    if (!std::isfinite(model[i])) return false;
  }
  if (!(model[kShape00] > 0.3) || !(model[kShape11] > 0.3) || model[kShape00] > 30 || model[kShape11] > 30)
    return false;
  // Perspective over one marker is mild (a slant of 75 degrees seen from four radii gives 0.24 to the rim, the steepest
  // view from two radii 0.6); beyond, the fit has run away, and pixels near the line at infinity would blow up.
  const double across = model[kLineY] / model[kShape11];
  const double along = (model[kLineX] - model[kShape10] * across) / model[kShape00];
  if (std::hypot(along, across) > 0.7) return false;
  if (!(model.blur_px() > 0.25) || model[kBlur] > 0.4) return false;
  if (!(model.contrast() > 1) || model[kInk] < -0.5) return false;
  for (int edge = 0; edge < model.edges(); ++edge) {
    const double inner = edge + 1 < model.edges() ? model.radius(edge + 1) : 0.0;
    if (!(model.radius(edge) > inner + 0.005)) return false;
  }
  return true;
}

}  // namespace roomcal::marker
