#include "runtime/map/sample_surface.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "runtime/map/format.h"

namespace roomcal::map {

namespace {

constexpr double kDefaultSpacing_m = 0.05;
constexpr double kMaxRows = 20000;  // 1 km at 5 cm; a damaged outline must not keep a device busy

double spacing_of(const RoomMap& map, double spacing_m) {
  if (spacing_m != 0) return spacing_m;
  return map.surface_spacing_m() > 0 ? map.surface_spacing_m() : kDefaultSpacing_m;
}

bool is_spacing(double spacing_m) { return spacing_m >= kMinSpacing_m && spacing_m <= kMaxSpacing_m; }

struct Interval {
  double low = 0, high = 0;
};

/// One plane's grid: rows along u at multiples of the spacing along v.
class PlaneGrid {
 public:
  PlaneGrid(const RoomMap& map, std::size_t plane, double spacing_m)
      : map_(map), plane_(plane), spacing_m_(spacing_m), size_(map.outline_size(plane)) {
    const MapPlane p = map.plane(plane);
    origin_ = -p.d_m * p.normal_room;
    u_ = p.normal_room.unitOrthogonal();
    v_ = p.normal_room.cross(u_);
  }

  /// @return false: more rows than a plane may have.
  bool fits() const {
    const Interval y = rows();
    return (y.high - y.low) / spacing_m_ < kMaxRows;
  }

  std::size_t count() const {
    std::size_t points = 0;
    walk_rows([&](double, double first, double last) { points += last < first ? 0 : to_count(last - first) + 1; });
    return points;
  }

  /// @param take  called with each point.
  template <typename Take>
  void walk(const Take& take) const {
    walk_rows([&](double row, double first, double last) {
      for (double column = first; column <= last; column += 1)
        take(Vec3(origin_ + column * spacing_m_ * u_ + row * spacing_m_ * v_));
    });
  }

 private:
  static std::size_t to_count(double whole) { return static_cast<std::size_t>(whole); }

  Interval rows() const {
    Interval y;
    for (std::size_t i = 0; i < size_; ++i) {
      y.low = i == 0 ? vertex(i).y() : std::min(y.low, vertex(i).y());
      y.high = i == 0 ? vertex(i).y() : std::max(y.high, vertex(i).y());
    }
    return y;
  }

  /// @param take  called with each row and its first and last column.
  template <typename Take>
  void walk_rows(const Take& take) const {
    if (size_ < 3) return;
    const Interval y = rows();
    for (double row = std::ceil(y.low / spacing_m_); row * spacing_m_ <= y.high; row += 1) {
      Interval x;
      if (span_at(row * spacing_m_, x)) take(row, std::ceil(x.low / spacing_m_), std::floor(x.high / spacing_m_));
    }
  }

  Vec2 vertex(std::size_t i) const {
    const Vec3 arm = map_.outline_vertex_room(plane_, i % size_) - origin_;
    return {u_.dot(arm), v_.dot(arm)};
  }

  bool span_at(double y, Interval& x) const {
    x = {1e300, -1e300};
    for (std::size_t i = 0; i < size_; ++i) {
      const Vec2 a = vertex(i), b = vertex(i + 1);
      if ((a.y() < y && b.y() < y) || (a.y() > y && b.y() > y)) continue;
      // An edge along the row counts with both its ends: the next edge brings the other one.
      const double part = a.y() == b.y() ? 0.0 : (y - a.y()) / (b.y() - a.y());
      const double at = a.x() + part * (b.x() - a.x());
      x.low = std::min(x.low, at);
      x.high = std::max(x.high, at);
    }
    return x.low <= x.high;
  }

  const RoomMap& map_;
  std::size_t plane_;
  double spacing_m_;
  std::size_t size_;
  Vec3 origin_, u_, v_;
};

}  // namespace

std::size_t surface_point_count(const RoomMap& map, double spacing_m) {
  const double spacing = spacing_of(map, spacing_m);
  if (!is_spacing(spacing)) return 0;
  std::size_t count = 0;
  for (std::size_t p = 0; p < map.plane_count(); ++p) {
    const PlaneGrid grid(map, p, spacing);
    if (!grid.fits()) return 0;
    count += grid.count();
  }
  return count;
}

Status sample_surface(const RoomMap& map, double spacing_m, Arena& arena, std::span<SurfacePoint>& points) {
  points = {};
  const double spacing = spacing_of(map, spacing_m);
  if (!is_spacing(spacing)) return {StatusCode::kInvalidArgument, "surface spacing out of range"};
  for (std::size_t p = 0; p < map.plane_count(); ++p) {
    if (!PlaneGrid(map, p, spacing).fits())
      return {StatusCode::kInvalidArgument, "surface spacing too fine for the planes' outlines"};
  }
  const std::size_t count = surface_point_count(map, spacing);
  const std::span<SurfacePoint> all = arena.allocate<SurfacePoint>(count);
  if (all.size() != count) return out_of_arena("surface points");
  std::size_t next = 0;
  for (std::size_t p = 0; p < map.plane_count(); ++p) {
    PlaneGrid(map, p, spacing).walk([&](const Vec3& p_room) {
      all[next++] = {p_room.cast<float>(), static_cast<uint16_t>(p)};
    });
  }
  points = all;
  return ok_status();
}

}  // namespace roomcal::map
