#include "tools/map/convex.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace roomcal::tools {

PlaneAxes::PlaneAxes(const Vec3& normal_room, double d_m)
    : origin_room(-d_m * normal_room), u(normal_room.unitOrthogonal()), v(normal_room.cross(u)) {}

std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  const auto before = [](const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vec2> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t base = hull.size();
    for (const Vec2& p : points) {
      while (hull.size() >= base + 2) {
        const Vec2 edge = hull.back() - hull[hull.size() - 2];
        const Vec2 turn = p - hull.back();
        if (edge.x() * turn.y() - edge.y() * turn.x() > 0) break;
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

std::vector<Vec2> clip_convex(const std::vector<Vec2>& polygon, const Vec2& inward, double offset) {
  std::vector<Vec2> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double in_a = inward.dot(a) - offset, in_b = inward.dot(b) - offset;
    if (in_a >= 0) kept.push_back(a);
    if ((in_a > 0 && in_b < 0) || (in_a < 0 && in_b > 0)) kept.push_back(a + (b - a) * (in_a / (in_a - in_b)));
  }
  return kept;
}

}  // namespace roomcal::tools
