#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "runtime/base/status.h"
#include "runtime/math/types.h"

namespace roomcal::map {

/// One ring marker of the room. A map from outside may lack normal and radius; `has_*` says so.
struct MapMarker {
  uint32_t id = 0;                  ///< number in the survey, for people; nothing identifies a marker in an image
  Vec3 p_room = Vec3::Zero();       ///< circle centre, m
  Mat33 cov_m2 = Mat33::Zero();     ///< of p_room; zero if the map claims to be exact
  Vec3 normal_room = Vec3::Zero();  ///< unit, into the room; estimated from neighbours where the source had none
  double radius_m = 0;              ///< outer radius
  bool has_normal = false;
  bool has_radius = false;
};

/// A planar surface: normal_room . p + d_m = 0, the normal points into free space.
struct MapPlane {
  Vec3 normal_room = Vec3::UnitZ();
  double d_m = 0;
};

/// Read-only view of a baked room (`*.room`, FlatBuffers, schema room.fbs). Owns nothing: the bytes must outlive it.
class RoomMap {
 public:
  RoomMap() = default;

  /// Checks everything before anything is used: magic, version, FlatBuffers structure, CRC-32C, finite numbers,
  /// symmetric positive semi-definite covariance, unit normals, indices in range.
  ///
  /// @param bytes  aligned to 8; must outlive the view.
  /// @return kCorrupt (truncated, damaged, not finite, inconsistent), kUnsupported (another version), with the reason.
  /// Cost: linear in the size, no allocation.
  static Result<RoomMap> open(std::span<const std::byte> bytes);

  std::size_t marker_count() const { return marker_count_; }
  MapMarker marker(std::size_t i) const;
  std::size_t plane_count() const;
  MapPlane plane(std::size_t i) const;

  /// Triples of marker numbers that may be neighbours in an image; see triangle_index.h.
  std::span<const std::array<uint16_t, 3>> triangles() const;

  std::string_view map_id() const;
  std::string_view provenance() const;
  /// CRC-32C of the content, as stored in the calibration record.
  uint32_t content_crc32c() const;

 private:
  std::span<const std::byte> bytes_;
  std::size_t marker_count_ = 0;
};

}  // namespace roomcal::map
