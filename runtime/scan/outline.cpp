#include "runtime/scan/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace roomcal::scan {

namespace {

using map::MapPlane;

constexpr double kFar_m = 1e3;         // where an outline begins before it is clipped
constexpr double kOnPlane_m = 0.03;    // walls bow, and markers have thickness
constexpr double kParallelCos = 0.95;  // planes that meet at less than 18 degrees meet nowhere in particular
constexpr double kInnerGap_m = 1.0;    // markers keep this far off an edge, at most
constexpr double kOuterGap_m = 0.4;    // the same for a pillar's edge: its faces are narrow
constexpr double kSharedEdge = 0.3;    // of the shorter extent along the line where two planes meet

double height_m(const MapPlane& plane, const Vec3& p_room) { return plane.normal_room.dot(p_room) + plane.d_m; }

struct Interval {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

Interval heights(const PlaneExtent& over, const std::span<const Vec3> points) {
  Interval heights;
  for (const Vec3& p : points) heights.add(height_m(over.plane, p));
  return heights;
}

Interval extent_along(const Vec3& direction, std::span<const Vec3> points) {
  Interval extent;
  for (const Vec3& p : points) extent.add(direction.dot(p));
  return extent;
}

/// Whether both reach along the line in which they meet.
bool share_an_edge(const PlaneExtent& a, const PlaneExtent& b) {
  const Vec3 line = a.plane.normal_room.cross(b.plane.normal_room).normalized();
  const Interval of_a = extent_along(line, a.points_room), of_b = extent_along(line, b.points_room);
  const double shared_m = std::min(of_a.high, of_b.high) - std::max(of_a.low, of_b.low);
  return shared_m >= kSharedEdge * std::min(of_a.high - of_a.low, of_b.high - of_b.low);
}

enum class Side { kNone, kFront, kBack };

/// On which side of `other` the outline of `own` ends, if it ends there.
Side end_at(const PlaneExtent& own, const PlaneExtent& other) {
  if (std::abs(own.plane.normal_room.dot(other.plane.normal_room)) > kParallelCos) return Side::kNone;
  if (own.points_room.empty() || other.points_room.empty()) return Side::kFront;  // nothing known: clip
  const Interval own_over = heights(other, own.points_room);
  const Interval other_over = heights(own, other.points_room);
  if (own_over.high < kOnPlane_m && other_over.high < kOnPlane_m) {
    const bool near = own_over.high > -kOuterGap_m && other_over.high > -kOuterGap_m;
    return near && share_an_edge(own, other) ? Side::kBack : Side::kNone;
  }
  if (own_over.low < -kOnPlane_m) return Side::kNone;  // passes through the other plane
  const bool reaches = other_over.low < kInnerGap_m;   // below zero: the other passes through our plane
  return reaches && own_over.low < 2 * kInnerGap_m && share_an_edge(own, other) ? Side::kFront : Side::kNone;
}

/// Keeps what is in front of the plane (Sutherland, Hodgman 1974, one plane).
Outline clip(const Outline& outline, const Vec3& normal, double d_m) {
  Outline kept;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec3& a = outline[i];
    const Vec3& b = outline[(i + 1) % outline.size()];
    const double at_a = normal.dot(a) + d_m, at_b = normal.dot(b) + d_m;
    // A full outline loses a vertex: capacity leaves room for as many edges as kMaxFaceEdges planes.
    if (at_a >= 0 && !kept.push_back(a)) break;
    if ((at_a >= 0) != (at_b >= 0) && !kept.push_back(a + (b - a) * (at_a / (at_a - at_b)))) break;
  }
  if (kept.size() < 3) kept.clear();
  return kept;
}

/// How far anything is known of the room.
double known_extent(const Vec3& axis, std::span<const PlaneExtent> planes) {
  double high_m = -kFar_m;
  for (const PlaneExtent& plane : planes)
    if (!plane.points_room.empty()) high_m = std::max(high_m, extent_along(axis, plane.points_room).high);
  return high_m;
}

/// Cuts the sides that no neighbour has clipped, or only where nothing of the room is known: walls that lean towards
/// each other by a fraction of a degree meet hundreds of metres above it.
Outline close_open_sides(Outline outline, const PlaneExtent& own, std::span<const PlaneExtent> planes, const Vec3& u,
                         const Vec3& v, double margin_m) {
  // Up and down first: the tip where two walls meet, cut off, no longer stretches the wall sideways.
  for (const Vec3& axis : {v, Vec3(-v), u, Vec3(-u)}) {
    const double known_m = known_extent(axis, planes);
    const double open_m = known_m > -kFar_m ? std::min(kFar_m / 2, known_m + kInnerGap_m) : kFar_m / 2;
    if (extent_along(axis, outline.span()).high < open_m) continue;
    const double end_m = own.points_room.empty() ? kFar_m / 4 : extent_along(axis, own.points_room).high + margin_m;
    outline = clip(outline, -axis, end_m);
  }
  return outline;
}

}  // namespace

Outline grow_outline(std::span<const PlaneExtent> planes, std::size_t i, double open_margin_m) {
  const PlaneExtent& own = planes[i];
  const Vec3& n = own.plane.normal_room;
  // Upright walls are cut level where they are open, so the axes follow the vertical.
  const Vec3 u = std::abs(n.z()) < 0.9 ? Vec3(Vec3::UnitZ().cross(n).normalized()) : Vec3(n.unitOrthogonal());
  const Vec3 v = n.cross(u);
  const Vec3 middle = own.points_room.empty() ? Vec3(-n * own.plane.d_m) : own.points_room[0];
  const Vec3 origin = middle - n * height_m(own.plane, middle);
  Outline outline;
  for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    if (!outline.push_back(origin + kFar_m * (a * u + b * v))) break;
  }
  for (std::size_t j = 0; j < planes.size(); ++j) {
    if (j == i) continue;
    const Side side = end_at(own, planes[j]);
    const MapPlane& other = planes[j].plane;
    if (side == Side::kFront) outline = clip(outline, other.normal_room, other.d_m);
    if (side == Side::kBack) outline = clip(outline, -other.normal_room, -other.d_m);
  }
  return close_open_sides(outline, own, planes, u, v, open_margin_m);
}

}  // namespace roomcal::scan
