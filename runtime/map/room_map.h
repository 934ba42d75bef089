#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "runtime/base/status.h"
#include "runtime/math/types.h"

namespace roomcal::map {

namespace fbs {
struct RoomMap;  // generated from room.fbs; only room_map.cpp and its builder look inside
}

/// One ring marker of the room. A map from outside may lack normal and radius; `has_*` says so.
struct MapMarker {
  uint32_t id = 0;               ///< number in the survey, for people; nothing identifies a marker in an image
  Vec3 p_room = Vec3::Zero();    ///< circle centre, m
  Mat33 cov_m2 = Mat33::Zero();  ///< of p_room; zero if the map claims to be exact
  Vec3 normal_room =
      Vec3::Zero();     ///< unit within 1e-6, into the room; estimated from the plane where the source had none
  double radius_m = 0;  ///< outer radius
  bool has_normal = false;
  bool has_radius = false;
  bool normal_estimated = false;  ///< the normal is that of the plane fitted to the markers around it
  int plane = -1;                 ///< number of the plane it lies on; -1: on none
};

/// A planar surface: normal_room . p + d_m = 0, the normal points into free space.
struct MapPlane {
  Vec3 normal_room = Vec3::UnitZ();
  double d_m = 0;
  double rms_m = 0;  ///< of its markers' distances to it
  /// Of its error (offset, tilt along u, tilt along v), see plane_error.h; (m, rad). Zero: exact, or a map from before.
  Mat33 cov = Mat33::Zero();
};

/// Edge of the room: two planes meet from `from_room` to `to_room`.
struct MapLine {
  std::size_t plane_a = 0, plane_b = 0;  ///< ascending
  Vec3 from_room = Vec3::Zero(), to_room = Vec3::Zero();
};

/// Where three planes of the room meet.
struct MapCorner {
  std::array<std::size_t, 3> planes{};  ///< ascending
  Vec3 p_room = Vec3::Zero();
};

/// Read-only view of a baked room (`*.room`, FlatBuffers, schema room.fbs). Owns nothing: the bytes must outlive it.
class RoomMap {
 public:
  /// An empty map: no markers, no planes, no triangles.
  RoomMap() = default;

  /// Checks everything before anything is used: magic, version, sizes, both CRC-32C, FlatBuffers structure, and then
  /// the content: finite numbers, positive semi-definite covariances, unit normals, ids ascending, indices in range,
  /// lines and corners on their planes, counts within the limits of format.h.
  ///
  /// @param bytes  aligned to 8; must outlive the view.
  /// @return kInvalidArgument (bytes not aligned), kCorrupt (truncated, damaged, not finite, inconsistent),
  ///         kUnsupported (another format or version), each with its own reason.
  /// Cost: linear in the size, no allocation.
  static Result<RoomMap> open(std::span<const std::byte> bytes);

  std::size_t marker_count() const { return marker_count_; }
  /// @param i  below marker_count(). Markers come by ascending id.
  MapMarker marker(std::size_t i) const;

  std::size_t plane_count() const;
  /// @param i  below plane_count().
  MapPlane plane(std::size_t i) const;
  /// Vertices of the plane's convex outline, counter-clockwise seen from free space; 0 if it has none.
  std::size_t outline_size(std::size_t plane) const;
  Vec3 outline_vertex_room(std::size_t plane, std::size_t vertex) const;

  /// Edges and corners, stored as floats (0.3 um at 4 m); a map from before they existed has none.
  std::size_t line_count() const;
  MapLine line(std::size_t i) const;
  std::size_t corner_count() const;
  MapCorner corner(std::size_t i) const;

  /// Spacing of the points that stand for the planes' surface, see sample_surface.h; 0: not recorded.
  double surface_spacing_m() const;

  /// Triples of marker numbers that may be neighbours in an image; see triangle_index.h.
  std::span<const std::array<uint16_t, 3>> triangles() const;

  /// Radii of the printed rings' edges over the outer radius, descending from 1; empty if not known.
  std::span<const float> ring_ratios() const;

  std::string_view map_id() const;
  std::string_view provenance() const;
  /// Unix time of the bake, s; 0 if not recorded. Not part of the content: see format.h.
  int64_t created_unix_s() const { return created_unix_s_; }
  /// CRC-32C of the content, as stored in the calibration record.
  uint32_t content_crc32c() const { return content_crc32c_; }

 private:
  const fbs::RoomMap* content_ = nullptr;
  std::size_t marker_count_ = 0;
  int64_t created_unix_s_ = 0;
  uint32_t content_crc32c_ = 0;
};

}  // namespace roomcal::map
