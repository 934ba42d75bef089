#include "tools/map/structure.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "runtime/map/format.h"
#include "tools/map/convex.h"

namespace roomcal::tools {

namespace {

using map::MapMarker;
using map::MapPlane;

struct Span {
  double min = 1e300, max = -1e300;
  void take(double x) {
    min = std::min(min, x);
    max = std::max(max, x);
  }
};

/// Common line of two planes that meet.
struct Edge {
  std::size_t plane_a = 0, plane_b = 0;
  Vec3 on_line = Vec3::Zero(), direction = Vec3::UnitX();
};

double height_m(const MapPlane& plane, const Vec3& p_room) { return plane.normal_room.dot(p_room) + plane.d_m; }

class StructureFinder {
 public:
  StructureFinder(MapData& data, const StructureOptions& options)
      : data_(data), options_(options), members_(data.planes.size()) {
    for (const MapMarker& marker : data.markers) {
      if (marker.plane >= 0) members_[static_cast<std::size_t>(marker.plane)].push_back(&marker);
    }
  }

  void run() {
    find_edges();
    std::vector<std::vector<Vec2>> outlines;
    for (std::size_t p = 0; p < data_.planes.size(); ++p) outlines.push_back(grown_outline(p));
    for (std::size_t p = 0; p < data_.planes.size(); ++p) store_outline(p, outlines[p]);
    data_.lines.clear();
    data_.corners.clear();
    for (const Edge& edge : edges_) add_line(edge, outlines);
    add_corners(outlines);
  }

 private:
  static constexpr double kSameVertex_m = 0.002;

  const MapPlane& plane(std::size_t p) const { return data_.planes[p].plane; }
  PlaneAxes axes(std::size_t p) const { return {plane(p).normal_room, plane(p).d_m}; }

  void find_edges() {
    for (std::size_t a = 0; a < data_.planes.size(); ++a) {
      for (std::size_t b = a + 1; b < data_.planes.size(); ++b) {
        Vec3 direction = plane(a).normal_room.cross(plane(b).normal_room);
        if (direction.norm() < 0.5) continue;
        direction.normalize();
        Mat33 rows;
        rows << plane(a).normal_room.transpose(), plane(b).normal_room.transpose(), direction.transpose();
        const Edge edge{a, b, rows.inverse() * Vec3(-plane(a).d_m, -plane(b).d_m, 0), direction};
        const Span near_a = near_span(a, edge), near_b = near_span(b, edge);
        if (std::max(near_a.min, near_b.min) < std::min(near_a.max, near_b.max)) edges_.push_back(edge);
      }
    }
  }

  /// Along the line, of the plane's markers that are near it.
  Span near_span(std::size_t p, const Edge& edge) const {
    Span span;
    for (const MapMarker* marker : members_[p]) {
      const Vec3 arm = marker->p_room - edge.on_line;
      const double along_m = arm.dot(edge.direction);
      if ((arm - along_m * edge.direction).norm() <= options_.reach_m) span.take(along_m);
    }
    return span;
  }

  /// Side of plane `other` on which all markers of `p` are: +1, -1, or 0 for both. A few misplaced ones do not count.
  int side_of(std::size_t p, std::size_t other) const {
    std::size_t before = 0, behind = 0;
    for (const MapMarker* marker : members_[p]) {
      const double h_m = height_m(plane(other), marker->p_room);
      before += h_m > options_.off_side_m;
      behind += h_m < -options_.off_side_m;
    }
    if (50 * behind <= before) return 1;
    return 50 * before <= behind ? -1 : 0;
  }

  /// Hull of the sheets' rims, extended to the lines that bound the plane and cut there.
  std::vector<Vec2> grown_outline(std::size_t p) const {
    const PlaneAxes to = axes(p);
    std::vector<Vec2> points = rims(p, to);
    std::vector<std::pair<const Edge*, int>> bounds;
    for (const Edge& edge : edges_) {
      if (edge.plane_a != p && edge.plane_b != p) continue;
      const int side = side_of(p, edge.plane_a == p ? edge.plane_b : edge.plane_a);
      if (side != 0) bounds.emplace_back(&edge, side);
    }
    // Once along the markers, once more along what that added: so corners are reached.
    for (int round = 0; round < 2; ++round) extend(bounds, to, points);
    std::vector<Vec2> outline = convex_hull(points);
    for (const auto& [edge, side] : bounds) {
      const MapPlane& other = plane(edge->plane_a == p ? edge->plane_b : edge->plane_a);
      const Vec2 inward = side * Vec2(other.normal_room.dot(to.u), other.normal_room.dot(to.v));
      outline = clip_convex(outline, inward, -side * height_m(other, to.origin_room));
    }
    return without_close(convex_hull(outline));
  }

  /// Lines that meet in a corner leave several vertices there, microns apart.
  static std::vector<Vec2> without_close(const std::vector<Vec2>& polygon) {
    std::vector<Vec2> kept;
    for (const Vec2& vertex : polygon) {
      const bool is_new = kept.empty() || ((vertex - kept.back()).norm() > kSameVertex_m &&
                                           (vertex - kept.front()).norm() > kSameVertex_m);
      if (is_new) kept.push_back(vertex);
    }
    return kept;
  }

  std::vector<Vec2> rims(std::size_t p, const PlaneAxes& to) const {
    constexpr int kRimPoints = 8;
    std::vector<Vec2> points;
    for (const MapMarker* marker : members_[p]) {
      const Vec2 centre = to.to_plane(marker->p_room);
      for (int i = 0; i < kRimPoints; ++i) {
        const double turn_rad = 2 * kPi * i / kRimPoints;
        points.push_back(centre + marker->radius_m * Vec2(std::cos(turn_rad), std::sin(turn_rad)));
      }
    }
    return points;
  }

  static void extend(const std::vector<std::pair<const Edge*, int>>& bounds, const PlaneAxes& to,
                     std::vector<Vec2>& points) {
    std::vector<Vec2> added;
    for (const auto& bound : bounds) {
      const Edge& edge = *bound.first;
      Span span;
      for (const Vec2& p : points) span.take(edge.direction.dot(to.to_room(p) - edge.on_line));
      for (const double at : {span.min, span.max}) added.push_back(to.to_plane(edge.on_line + at * edge.direction));
    }
    points.insert(points.end(), added.begin(), added.end());
  }

  void store_outline(std::size_t p, const std::vector<Vec2>& outline) const {
    std::vector<Vec3>& stored = data_.planes[p].outline_room;
    stored.clear();
    if (outline.size() < 3 || outline.size() > map::kMaxOutline) return;
    for (const Vec2& vertex : outline) stored.push_back(axes(p).to_room(vertex));
  }

  /// Part of a line within an outline, widened a little: a bounding line runs along its rim.
  Span span_within(const Edge& edge, std::size_t p, const std::vector<Vec2>& outline) const {
    constexpr double kRim_m = 2.5 * kSameVertex_m;
    constexpr double kFar_m = 1e5;
    const PlaneAxes to = axes(p);
    const Vec2 at = to.to_plane(edge.on_line);
    const Vec2 along(edge.direction.dot(to.u), edge.direction.dot(to.v));
    Span span{-kFar_m, kFar_m};
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vec2 side = (outline[(i + 1) % outline.size()] - outline[i]).normalized();
      const Vec2 inward(-side.y(), side.x());
      const double in_m = inward.dot(at - outline[i]) + kRim_m, slope = inward.dot(along);
      if (std::abs(slope) < 1e-6) {
        if (in_m < 0) return {1, 0};
        continue;
      }
      (slope > 0 ? span.min : span.max) =
          slope > 0 ? std::max(span.min, -in_m / slope) : std::min(span.max, -in_m / slope);
    }
    return span;
  }

  void add_line(const Edge& edge, const std::vector<std::vector<Vec2>>& outlines) {
    constexpr double kShortest_m = 0.1;
    const Span a = span_within(edge, edge.plane_a, outlines[edge.plane_a]);
    const Span b = span_within(edge, edge.plane_b, outlines[edge.plane_b]);
    const double from = std::max(a.min, b.min), to = std::min(a.max, b.max);
    if (to - from < kShortest_m || data_.lines.size() >= map::kMaxLines) return;
    data_.lines.push_back(
        {edge.plane_a, edge.plane_b, edge.on_line + from * edge.direction, edge.on_line + to * edge.direction});
  }

  bool has_line(std::size_t a, std::size_t b) const {
    return std::any_of(data_.lines.begin(), data_.lines.end(),
                       [&](const map::MapLine& line) { return line.plane_a == a && line.plane_b == b; });
  }

  bool is_within(const Vec3& p_room, std::size_t p, const std::vector<Vec2>& outline) const {
    const Vec2 at = axes(p).to_plane(p_room);
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Vec2 side = (outline[(i + 1) % outline.size()] - outline[i]).normalized();
      if (Vec2(-side.y(), side.x()).dot(at - outline[i]) < -options_.off_corner_m) return false;
    }
    return outline.size() >= 3;
  }

  void add_corners(const std::vector<std::vector<Vec2>>& outlines) {
    const std::size_t n = data_.planes.size();
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = a + 1; b < n; ++b) {
        if (!has_line(a, b)) continue;
        for (std::size_t c = b + 1; c < n; ++c) {
          if (has_line(b, c) && has_line(a, c)) add_corner({a, b, c}, outlines);
        }
      }
    }
  }

  void add_corner(const std::array<std::size_t, 3>& planes, const std::vector<std::vector<Vec2>>& outlines) {
    Mat33 rows;
    Vec3 d_m;
    for (int i = 0; i < 3; ++i) {
      rows.row(i) = plane(planes[static_cast<std::size_t>(i)]).normal_room.transpose();
      d_m[i] = plane(planes[static_cast<std::size_t>(i)]).d_m;
    }
    if (std::abs(rows.determinant()) < 0.3 || data_.corners.size() >= map::kMaxCorners) return;
    const Vec3 p_room = rows.inverse() * -d_m;
    const auto holds = [&](std::size_t p) { return is_within(p_room, p, outlines[p]); };
    if (!std::all_of(planes.begin(), planes.end(), holds)) return;
    data_.corners.push_back({planes, p_room});
    for (map::MapLine& line : data_.lines) end_in(planes, p_room, line);
  }

  void end_in(const std::array<std::size_t, 3>& planes, const Vec3& corner, map::MapLine& line) const {
    const auto meets = [&](std::size_t p) { return std::find(planes.begin(), planes.end(), p) != planes.end(); };
    if (!meets(line.plane_a) || !meets(line.plane_b)) return;
    for (Vec3* end : {&line.from_room, &line.to_room}) {
      if ((*end - corner).norm() < options_.off_corner_m) *end = corner;
    }
  }

  MapData& data_;
  const StructureOptions& options_;
  std::vector<std::vector<const MapMarker*>> members_;
  std::vector<Edge> edges_;
};

}  // namespace

void find_structure(MapData& data, const StructureOptions& options) { StructureFinder(data, options).run(); }

}  // namespace roomcal::tools
