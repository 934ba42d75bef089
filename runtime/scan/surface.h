#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/map/room_map.h"
#include "runtime/math/types.h"

namespace roomcal::scan {

inline constexpr std::size_t kMaxFaces = 64;
inline constexpr std::size_t kMaxFaceEdges = 32;
inline constexpr std::size_t kMaxEdges = 512;  ///< of all faces together

/// A planar piece of the room: normal_room . p + d_m = 0, free space in front, a convex outline.
struct Face {
  Vec3 normal_room = Vec3::UnitZ();
  double d_m = 0;
  uint32_t first = 0;  ///< of its vertices and edges in Surface
  uint32_t count = 0;
  uint32_t first_print = 0;  ///< likewise of its prints, which are in the order of this coordinate:
  uint32_t print_count = 0;
  uint8_t print_axis = 0;
};

/// Inner side of one edge of an outline: inward_room . p + d_m >= 0. The plane stands upright on the face.
struct FaceEdge {
  Vec3 inward_room = Vec3::UnitX();
  double d_m = 0;
};

/// One planar polygon to make a surface of.
struct Polygon {
  std::span<const Vec3> vertices_room;  ///< convex, planar, counter-clockwise seen from free space
};

/// A ring marker, for what its print does to reflectivities.
struct Print {
  Vec3 p_room = Vec3::Zero();
  double radius_m = 0;
  uint32_t face = 0;
};

struct SurfaceOptions {
  /// A plane of the map ends where it meets its neighbours, or this far beyond its outermost marker where it meets none
  /// (a wall without a known ceiling). Little: what is not wall there (the ceiling's first centimetres) would pull.
  double open_margin_m = 0.05;
};

/// The room as a sweep sees it: planes with convex outlines, made once before arming, read-only afterwards.
class Surface {
 public:
  Surface() = default;

  /// From the map's planes. Outlines are grown from the markers (from the map's outline where a plane has no marker) to
  /// the lines where planes meet: outlines through marker centres alone would leave a rim of 0.2 to 0.5 m unknown at
  /// every edge of the room. Markers with a radius become prints.
  /// @return kTooFew (no plane), kCapacity (more than kMaxFaces planes, or kMaxEdges edges), kOutOfMemory.
  /// Cost: planes^2 x outline.
  static Result<Surface> build(const map::RoomMap& map, const SurfaceOptions& options, Arena& permanent,
                               Arena& scratch);

  /// From polygons as they are (at most kMaxFaceEdges vertices each, three at least).
  /// @return kInvalidArgument (a polygon that is not one), kCapacity, kTooFew, kOutOfMemory.
  static Result<Surface> from_polygons(std::span<const Polygon> polygons, std::span<const Print> prints,
                                       Arena& permanent);

  /// Permanent bytes that either takes at most.
  static std::size_t bytes(std::size_t planes, std::size_t markers);

  std::span<const Face> faces() const { return faces_; }
  std::span<const Vec3> vertices_room(const Face& face) const { return vertices_.subspan(face.first, face.count); }
  std::span<const FaceEdge> edges(const Face& face) const { return edges_.subspan(face.first, face.count); }
  std::span<const Print> prints() const { return prints_; }  ///< face by face
  std::span<const Print> prints(const Face& face) const { return prints().subspan(face.first_print, face.print_count); }
  /// Those whose print_axis coordinate is within an interval. Cost: logarithmic.
  std::span<const Print> prints_between(const Face& face, double low_m, double high_m) const;
  double largest_print_m() const { return largest_print_m_; }  ///< radius
  const Vec3& low_room() const { return low_room_; }
  const Vec3& high_room() const { return high_room_; }

 private:
  void sort_prints();
  Status add_face(const Vec3& normal_room, double d_m, std::span<const Vec3> vertices_room);

  std::span<Face> faces_;
  std::span<Vec3> vertices_;
  std::span<FaceEdge> edges_;
  std::span<Print> prints_;
  double largest_print_m_ = 0;
  Vec3 low_room_ = Vec3::Constant(1e30);
  Vec3 high_room_ = Vec3::Constant(-1e30);
};

}  // namespace roomcal::scan
