#include "tools/bake/room_axes.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

namespace roomcal::tools {

namespace {

using map::MapMarker;
using map::MapPlane;

double height_m(const MapPlane& plane, const Vec3& p) { return plane.normal_room.dot(p) + plane.d_m; }

/// Nothing of the room is below its floor; a few misplaced markers do not change that.
std::optional<std::size_t> find_floor(const std::vector<MapMarker>& markers, const std::vector<PlaneData>& planes,
                                      const Vec3& up_hint) {
  constexpr double kMinUpness = 0.5;
  constexpr double kBelow_m = 0.05;
  std::optional<std::size_t> floor;
  double best = kMinUpness;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const MapPlane& plane = planes[i].plane;
    const auto below = std::count_if(markers.begin(), markers.end(),
                                     [&](const MapMarker& m) { return height_m(plane, m.p_room) < -kBelow_m; });
    const double upness = plane.normal_room.dot(up_hint);
    if (50 * static_cast<std::size_t>(below) > markers.size() || upness < best) continue;
    best = upness;
    floor = i;
  }
  return floor;
}

/// Direction of the wall that holds most markers, in the floor: walls are at right angles in most rooms.
Vec3 wall_direction(const std::vector<PlaneData>& planes, const Vec3& up) {
  for (const PlaneData& data : planes) {  // largest first
    const Vec3& normal = data.plane.normal_room;
    if (std::abs(normal.dot(up)) < 0.2) return (normal - normal.dot(up) * up).normalized();
  }
  return up.unitOrthogonal();
}

struct Extent {
  double min = 1e300, max = -1e300;
  void take(double x) {
    min = std::min(min, x);
    max = std::max(max, x);
  }
  double size() const { return max - min; }
};

Extent extent_along(const std::vector<MapMarker>& markers, const Vec3& axis) {
  Extent extent;
  for (const MapMarker& marker : markers) extent.take(axis.dot(marker.p_room));
  return extent;
}

/// The plane's place along an axis that it faces, else where the markers end.
double wall_at(const std::vector<PlaneData>& planes, const Vec3& axis, const Vec3& inside, double otherwise) {
  for (const PlaneData& data : planes) {
    const MapPlane& plane = data.plane;
    const double slope = plane.normal_room.dot(axis);
    if (slope < 0.97) continue;
    const double at = axis.dot(inside) - height_m(plane, inside) / slope;
    if (std::abs(at - otherwise) < 0.3) return at;
  }
  return otherwise;
}

}  // namespace

RoomAxes find_axes(const std::vector<MapMarker>& markers, const std::vector<PlaneData>& planes, const Vec3& start,
                   const Vec3& up_hint) {
  RoomAxes axes;
  const std::optional<std::size_t> found = find_floor(markers, planes, up_hint);
  if (!found) {
    axes.description =
        "no floor found (no plane below all markers that faces up): axes are the first pair's left camera";
    return axes;
  }
  const MapPlane& floor = planes[*found].plane;
  const Vec3 z = floor.normal_room;
  const Vec3 a = wall_direction(planes, z), b = z.cross(a);
  const bool a_shorter = extent_along(markers, a).size() <= extent_along(markers, b).size();
  Vec3 x = a_shorter ? a : b;
  // Right-handed: y = z cross x. Of x and -x, the one whose origin is nearer to the survey's start.
  SE3& best = axes.T_room_survey;
  double nearest = 1e300;
  for (const double sign : {1.0, -1.0}) {
    const Vec3 x_axis = sign * x, y_axis = z.cross(x_axis);
    const double x0 = wall_at(planes, x_axis, start, extent_along(markers, x_axis).min);
    const double y0 = wall_at(planes, y_axis, start, extent_along(markers, y_axis).min);
    const double away_m = std::hypot(x_axis.dot(start) - x0, y_axis.dot(start) - y0);
    if (away_m >= nearest) continue;
    nearest = away_m;
    best.R << x_axis.transpose(), y_axis.transpose(), z.transpose();
    best.t = Vec3(-x0, -y0, floor.d_m);
  }
  axes.has_floor = true;
  axes.description =
      "z up from the floor plane at z = 0, x along the shorter side, origin in the floor corner nearer to the survey's "
      "start";
  return axes;
}

}  // namespace roomcal::tools
