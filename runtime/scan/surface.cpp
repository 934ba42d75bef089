#include "runtime/scan/surface.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "runtime/scan/outline.h"

namespace roomcal::scan {

namespace {

constexpr double kMinArea_m2 = 1e-4;
constexpr double kOffPlane_m = 1e-3;

Vec3 area_vector(std::span<const Vec3> vertices) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
    sum += (vertices[i] - vertices[0]).cross(vertices[i + 1] - vertices[0]);
  }
  return sum / 2;
}

/// Points known to lie on plane `i`: its markers, or its outline where it has fewer than three.
Status gather_points(const map::RoomMap& map, std::size_t i, Arena& scratch, std::span<const Vec3>& points) {
  std::size_t markers = 0;
  for (std::size_t k = 0; k < map.marker_count(); ++k) markers += map.marker(k).plane == static_cast<int>(i) ? 1U : 0U;
  const bool by_markers = markers >= 3;
  const std::size_t count = by_markers ? markers : map.outline_size(i);
  points = {};
  if (count == 0) return ok_status();
  const std::span<Vec3> room = scratch.allocate<Vec3>(count);
  if (room.empty()) return out_of_arena("scan: scratch arena too small for the map's planes");
  std::size_t filled = 0;
  for (std::size_t k = 0; k < (by_markers ? map.marker_count() : count); ++k) {
    if (!by_markers) {
      room[filled++] = map.outline_vertex_room(i, k);
    } else if (map.marker(k).plane == static_cast<int>(i)) {
      room[filled++] = map.marker(k).p_room;
    }
  }
  points = room;
  return ok_status();
}

std::size_t edge_capacity(std::size_t planes) { return std::min(planes * kMaxFaceEdges, kMaxEdges); }

}  // namespace

std::size_t Surface::bytes(std::size_t planes, std::size_t markers) {
  return planes * sizeof(Face) + edge_capacity(planes) * (sizeof(Vec3) + sizeof(FaceEdge)) + markers * sizeof(Print) +
         64;
}

Status Surface::add_face(const Vec3& normal_room, double d_m, std::span<const Vec3> vertices_room) {
  std::size_t face = 0;
  while (face < faces_.size() && faces_[face].count != 0) ++face;
  const uint32_t first = face == 0 ? 0 : faces_[face - 1].first + faces_[face - 1].count;
  if (first + vertices_room.size() > edges_.size()) {
    static_assert(kMaxEdges == 512);
    return {StatusCode::kCapacity, "scan: the planes have more than 512 edges together, leave planes out of the map"};
  }
  faces_[face] = {normal_room, d_m, first, static_cast<uint32_t>(vertices_room.size()), 0, 0};
  for (std::size_t i = 0; i < vertices_room.size(); ++i) {
    const Vec3& a = vertices_room[i];
    const Vec3& b = vertices_room[(i + 1) % vertices_room.size()];
    const Vec3 inward = normal_room.cross(b - a).normalized();
    vertices_[first + i] = a;
    edges_[first + i] = {inward, -inward.dot(a)};
    low_room_ = low_room_.cwiseMin(a);
    high_room_ = high_room_.cwiseMax(a);
  }
  return ok_status();
}

void Surface::sort_prints() {
  std::sort(prints_.begin(), prints_.end(), [](const Print& a, const Print& b) { return a.face < b.face; });
  for (uint32_t i = 0; i < prints_.size(); ++i) {
    Face& face = faces_[prints_[i].face];
    if (face.print_count++ == 0) face.first_print = i;
    largest_print_m_ = std::max(largest_print_m_, prints_[i].radius_m);
  }
  for (Face& face : faces_) {
    const std::span<Print> own = prints_.subspan(face.first_print, face.print_count);
    Vec3 low = Vec3::Constant(1e30), high = -low;
    for (const Print& print : own) {
      low = low.cwiseMin(print.p_room);
      high = high.cwiseMax(print.p_room);
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    face.print_axis = static_cast<uint8_t>(axis);
    std::sort(own.begin(), own.end(),
              [axis](const Print& a, const Print& b) { return a.p_room[axis] < b.p_room[axis]; });
  }
}

std::span<const Print> Surface::prints_between(const Face& face, double low_m, double high_m) const {
  const std::span<const Print> own = prints(face);
  const int axis = face.print_axis;
  const auto first =
      std::partition_point(own.begin(), own.end(), [&](const Print& p) { return p.p_room[axis] < low_m; });
  const auto last = std::partition_point(first, own.end(), [&](const Print& p) { return p.p_room[axis] <= high_m; });
  return {first, last};
}

Result<Surface> Surface::build(const map::RoomMap& map, const SurfaceOptions& options, Arena& permanent,
                               Arena& scratch) {
  const std::size_t count = map.plane_count();
  if (count == 0) return Status{StatusCode::kTooFew, "scan: the map has no plane, bake it from a survey with planes"};
  if (count > kMaxFaces) return Status{StatusCode::kCapacity, "scan: the map has more planes than a sweep is cast at"};
  const Arena::Scope scope(scratch);
  const std::span<PlaneExtent> planes = scratch.allocate<PlaneExtent>(count);
  if (planes.empty()) return out_of_arena("scan: scratch arena too small for the map's planes");
  for (std::size_t i = 0; i < count; ++i) {
    planes[i].plane = map.plane(i);
    ROOMCAL_TRY(gather_points(map, i, scratch, planes[i].points_room));
  }
  Surface surface;
  surface.faces_ = permanent.allocate<Face>(count);
  surface.vertices_ = permanent.allocate<Vec3>(edge_capacity(count));
  surface.edges_ = permanent.allocate<FaceEdge>(edge_capacity(count));
  surface.prints_ = permanent.allocate<Print>(map.marker_count());
  if (surface.edges_.empty() || surface.prints_.size() != map.marker_count()) {
    return out_of_arena("scan: permanent arena too small for the surface");
  }
  std::size_t kept = 0;
  std::array<int, kMaxFaces> face_of_plane{};
  for (std::size_t i = 0; i < count; ++i) {
    const Outline outline = grow_outline(planes, i, options.open_margin_m);
    face_of_plane[i] = outline.empty() ? -1 : static_cast<int>(kept++);
    if (!outline.empty()) {
      ROOMCAL_TRY(surface.add_face(planes[i].plane.normal_room, planes[i].plane.d_m, outline.span()));
    }
  }
  if (kept == 0) return Status{StatusCode::kTooFew, "scan: no plane of the map has an outline"};
  surface.faces_ = surface.faces_.first(kept);
  std::size_t prints = 0;
  for (std::size_t k = 0; k < map.marker_count(); ++k) {
    const map::MapMarker marker = map.marker(k);
    if (!marker.has_radius || marker.plane < 0 || face_of_plane[static_cast<std::size_t>(marker.plane)] < 0) continue;
    const int face = face_of_plane[static_cast<std::size_t>(marker.plane)];
    surface.prints_[prints++] = {marker.p_room, marker.radius_m, static_cast<uint32_t>(face)};
  }
  surface.prints_ = surface.prints_.first(prints);
  surface.sort_prints();
  return surface;
}

Result<Surface> Surface::from_polygons(std::span<const Polygon> polygons, std::span<const Print> prints,
                                       Arena& permanent) {
  if (polygons.empty()) return Status{StatusCode::kTooFew, "scan: a surface needs a polygon"};
  if (polygons.size() > kMaxFaces) return Status{StatusCode::kCapacity, "scan: too many polygons"};
  Surface surface;
  surface.faces_ = permanent.allocate<Face>(polygons.size());
  surface.vertices_ = permanent.allocate<Vec3>(edge_capacity(polygons.size()));
  surface.edges_ = permanent.allocate<FaceEdge>(edge_capacity(polygons.size()));
  surface.prints_ = permanent.allocate<Print>(prints.size());
  if (surface.edges_.empty() || surface.prints_.size() != prints.size()) {
    return out_of_arena("scan: permanent arena too small for the surface");
  }
  for (const Polygon& polygon : polygons) {
    const std::span<const Vec3> vertices = polygon.vertices_room;
    if (vertices.size() < 3) return Status{StatusCode::kInvalidArgument, "scan: a polygon has three vertices at least"};
    if (vertices.size() > kMaxFaceEdges) return Status{StatusCode::kCapacity, "scan: a polygon has too many vertices"};
    const Vec3 area = area_vector(vertices);
    if (!(area.norm() > kMinArea_m2)) return Status{StatusCode::kInvalidArgument, "scan: a polygon without area"};
    const Vec3 normal = area.normalized();
    const double d_m = -normal.dot(vertices[0]);
    for (const Vec3& p : vertices) {
      if (!(std::abs(normal.dot(p) + d_m) < kOffPlane_m)) {
        return Status{StatusCode::kInvalidArgument, "scan: a polygon is not planar"};
      }
    }
    ROOMCAL_TRY(surface.add_face(normal, d_m, vertices));
  }
  for (std::size_t i = 0; i < prints.size(); ++i) {
    if (prints[i].face >= polygons.size()) return Status{StatusCode::kInvalidArgument, "scan: a print on no polygon"};
    surface.prints_[i] = prints[i];
  }
  surface.sort_prints();
  return surface;
}

}  // namespace roomcal::scan
