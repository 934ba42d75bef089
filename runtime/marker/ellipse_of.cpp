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

bool crosses_border(ImageView image, const Vec2& centre_px, const Mat22& S2_px2) {
  const double hx = std::sqrt(S2_px2(0, 0));
  const double hy = std::sqrt(S2_px2(1, 1));
  return centre_px.x() - hx < 0.5 || centre_px.y() - hy < 0.5 || centre_px.x() + hx > image.width() - 1.5 ||
         centre_px.y() + hy > image.height() - 1.5;
}

}  // namespace roomcal::marker
