#include "runtime/marker/ellipse_of.h"

#include <algorithm>
#include <cmath>

namespace roomcal::marker {

Ellipse ellipse_of(const Vec2& centre_px, const Mat22& S2_px2) {
  const double mean = (S2_px2(0, 0) + S2_px2(1, 1)) / 2;
  const double half_difference = (S2_px2(0, 0) - S2_px2(1, 1)) / 2;
  const double spread = std::hypot(half_difference, S2_px2(0, 1));
  return {centre_px, 2 * std::sqrt(mean + spread), 2 * std::sqrt(std::max(mean - spread, 0.0)),
          0.5 * std::atan2(S2_px2(0, 1), half_difference)};
}

double radius2_in(const Ellipse& ellipse, const Vec2& point_px) {
  const Vec2 axis(std::cos(ellipse.angle_rad), std::sin(ellipse.angle_rad));
  const Vec2 d = point_px - ellipse.centre_px;
  const double along = 2 * d.dot(axis) / ellipse.major_px;
  const double across = 2 * (d.y() * axis.x() - d.x() * axis.y()) / ellipse.minor_px;
  return along * along + across * across;
}

bool crosses_border(ImageView image, const Vec2& centre_px, const Mat22& S2_px2) {
  const double hx = std::sqrt(S2_px2(0, 0));
  const double hy = std::sqrt(S2_px2(1, 1));
  return centre_px.x() - hx < 0.5 || centre_px.y() - hy < 0.5 || centre_px.x() + hx > image.width() - 1.5 ||
         centre_px.y() + hy > image.height() - 1.5;
}

}  // namespace roomcal::marker
