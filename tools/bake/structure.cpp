#include "tools/bake/structure.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

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

SE3 find_axes(const std::vector<MapMarker>& markers, const std::vector<PlaneData>& planes, const Vec3& start,
              const Vec3& up_hint, Structure& structure) {
  structure.floor = find_floor(markers, planes, up_hint);
  if (!structure.floor) {
    structure.axes = "no floor found (no plane below all markers that faces up): axes are the first pair's left camera";
    return {};
  }
  const MapPlane& floor = planes[*structure.floor].plane;
  const Vec3 z = floor.normal_room;
  const Vec3 a = wall_direction(planes, z), b = z.cross(a);
  const bool a_shorter = extent_along(markers, a).size() <= extent_along(markers, b).size();
  Vec3 x = a_shorter ? a : b;
  // Right-handed: y = z cross x. Of x and -x, the one whose origin is nearer to the survey's start.
  SE3 best;
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
  structure.axes =
      "z up from the floor plane at z = 0, x along the shorter side, origin in the floor corner nearer to the survey's "
      "start";
  return best;
}

namespace {

/// Whether markers of the plane come near the line; extends the span that they cover along it.
bool reaches(const std::vector<MapMarker>& markers, std::size_t plane, const Vec3& on_line, const Vec3& direction,
             double reach_m, Extent& span) {
  bool near = false;
  for (const MapMarker& marker : markers) {
    if (marker.plane != static_cast<int>(plane)) continue;
    const Vec3 arm = marker.p_room - on_line;
    const double along = arm.dot(direction);
    if ((arm - along * direction).norm() > reach_m) continue;
    near = true;
    span.take(along);
  }
  return near;
}

void add_line(const std::vector<MapMarker>& markers, const std::vector<PlaneData>& planes, std::size_t a, std::size_t b,
              double reach_m, Structure& structure) {
  const MapPlane &plane_a = planes[a].plane, &plane_b = planes[b].plane;
  Vec3 direction = plane_a.normal_room.cross(plane_b.normal_room);
  if (direction.norm() < 0.5) return;
  direction.normalize();
  Mat33 rows;
  rows << plane_a.normal_room.transpose(), plane_b.normal_room.transpose(), direction.transpose();
  const Vec3 on_line = rows.inverse() * Vec3(-plane_a.d_m, -plane_b.d_m, 0);
  Extent span_a, span_b;
  if (!reaches(markers, a, on_line, direction, reach_m, span_a)) return;
  if (!reaches(markers, b, on_line, direction, reach_m, span_b)) return;
  const double from = std::max(span_a.min, span_b.min), to = std::min(span_a.max, span_b.max);
  if (to <= from) return;
  structure.lines.push_back({a, b, on_line + from * direction, on_line + to * direction});
}

bool has_line(const Structure& structure, std::size_t a, std::size_t b) {
  return std::any_of(structure.lines.begin(), structure.lines.end(),
                     [&](const RoomLine& line) { return line.plane_a == a && line.plane_b == b; });
}

void stretch_to(Structure& structure, std::size_t a, std::size_t b, const Vec3& corner) {
  for (RoomLine& line : structure.lines) {
    if (line.plane_a != a || line.plane_b != b) continue;
    const Vec3 direction = (line.to_room - line.from_room).normalized();
    if ((corner - line.from_room).dot(direction) < 0) line.from_room = corner;
    if ((corner - line.to_room).dot(direction) > 0) line.to_room = corner;
  }
}

}  // namespace

void find_edges(const std::vector<MapMarker>& markers, const std::vector<PlaneData>& planes, Structure& structure,
                double reach_m) {
  const std::size_t n = planes.size();
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) add_line(markers, planes, a, b, reach_m, structure);
  }
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      for (std::size_t c = b + 1; c < n; ++c) {
        if (!has_line(structure, a, b) || !has_line(structure, b, c) || !has_line(structure, a, c)) continue;
        Mat33 rows;
        rows << planes[a].plane.normal_room.transpose(), planes[b].plane.normal_room.transpose(),
            planes[c].plane.normal_room.transpose();
        if (std::abs(rows.determinant()) < 0.3) continue;
        const Vec3 corner = rows.inverse() * -Vec3(planes[a].plane.d_m, planes[b].plane.d_m, planes[c].plane.d_m);
        structure.corners.push_back({{a, b, c}, corner});
        stretch_to(structure, a, b, corner);
        stretch_to(structure, b, c, corner);
        stretch_to(structure, a, c, corner);
      }
    }
  }
}

}  // namespace roomcal::tools
