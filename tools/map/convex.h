#pragma once

#include <vector>

#include "runtime/math/types.h"

namespace roomcal::tools {

/// Coordinates in a plane: x along u, y along v, u x v = its normal.
struct PlaneAxes {
  Vec3 origin_room, u, v;

  /// @param normal_room  unit; the plane is normal . p + d = 0.
  PlaneAxes(const Vec3& normal_room, double d_m);
  Vec2 to_plane(const Vec3& p_room) const { return {u.dot(p_room - origin_room), v.dot(p_room - origin_room)}; }
  Vec3 to_room(const Vec2& p) const { return origin_room + u * p.x() + v * p.y(); }
};

/// Convex hull, counter-clockwise, without points on its edges (Andrew's monotone chain). Cost: n log n.
std::vector<Vec2> convex_hull(std::vector<Vec2> points);

/// The part of a convex polygon where inward . p >= offset.
std::vector<Vec2> clip_convex(const std::vector<Vec2>& polygon, const Vec2& inward, double offset);

}  // namespace roomcal::tools
