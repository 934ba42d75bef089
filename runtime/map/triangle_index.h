#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/map/room_map.h"
#include "runtime/math/types.h"

namespace roomcal::map {

/// Numbers of three markers. In a baked map they go counter-clockwise as the camera sees them from inside the room,
/// det[p0-c p1-c p2-c] > 0, and the triples come by how often they are neighbours in an image, most often first.
using MarkerTriple = std::array<uint16_t, 3>;

/// What the locator wants of a marker, decoded once.
struct IndexedMarker {
  static constexpr std::size_t kNeighbours = 8;

  Vec3 p_room = Vec3::Zero();
  Vec3 normal_room = Vec3::Zero();  ///< zero: not known
  Mat33 cov_m2 = Mat33::Zero();
  double sigma_m = 0;   ///< root of the largest variance in cov_m2
  double radius_m = 0;  ///< zero: not known
  bool has_normal = false;
  bool has_radius = false;
  uint8_t neighbours = 0;                         ///< how many of `neighbour` are filled
  std::array<uint16_t, kNeighbours> neighbour{};  ///< nearest markers, nearest first
};

struct IndexedTriple {
  MarkerTriple marker{};
  std::array<float, 3> edge_m{};  ///< edge i is opposite to marker i
};

/// The map's triangles, ready for matching: built once when the device arms, read-only afterwards.
class TriangleIndex {
 public:
  TriangleIndex() = default;

  /// Permanent bytes that build() takes.
  static std::size_t bytes(std::size_t markers, std::size_t triples);

  /// @param permanent  keeps the index; about 60 kB + 20 B a triple.
  /// @return kInvalidArgument (a number out of range), kOutOfMemory.
  /// Cost: markers^2 + triples log(triples).
  static Result<TriangleIndex> build(const RoomMap& map, Arena& permanent);
  /// The same from plain parts.
  static Result<TriangleIndex> build(std::span<const MapMarker> markers, std::span<const MarkerTriple> triples,
                                     Arena& permanent);

  std::span<const IndexedMarker> markers() const { return markers_; }
  /// In the order of the map: most probable first.
  std::span<const IndexedTriple> triples() const { return triples_; }
  /// Numbers of the triples whose longest edge lies in [low_m, high_m].
  std::span<const uint16_t> with_longest_edge(double low_m, double high_m) const;
  /// Outer radius of every marker, if all have the same within 1 %; else 0.
  double common_radius_m() const { return common_radius_m_; }
  const Vec3& low_room() const { return low_room_; }
  const Vec3& high_room() const { return high_room_; }

 private:
  Status allocate(std::size_t markers, std::size_t triples, Arena& permanent);
  Status finish(std::span<const MarkerTriple> triples);
  void find_neighbours();
  void find_bounds();

  std::span<IndexedMarker> markers_;
  std::span<IndexedTriple> triples_;
  std::span<uint16_t> by_longest_;
  double common_radius_m_ = 0;
  Vec3 low_room_ = Vec3::Zero();
  Vec3 high_room_ = Vec3::Zero();
};

/// Longest of the three edges, m.
float longest_edge_m(const IndexedTriple& triple);

}  // namespace roomcal::map
