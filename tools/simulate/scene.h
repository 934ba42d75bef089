#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "runtime/math/types.h"
#include "tools/common/ring_bank.h"

namespace roomcal::tools {

inline constexpr double kSheetWidth_m = 0.210;
inline constexpr double kSheetHeight_m = 0.297;
inline constexpr double kMarkerRadius_m = 0.085;
inline constexpr double kPaperAlbedo = 0.85;
inline constexpr double kInkAlbedo = 0.06;

/// What is printed on a piece of paper. All but kRings are there to fool the detector.
enum class Print : uint8_t { kRings, kDisc, kOneRing, kTwoRings, kFan, kStripes };

/// A piece of paper glued to a plane; coordinates are the plane's own (m).
struct Decal {
  Print print = Print::kRings;
  int marker_id = -1;  ///< of kRings only
  Vec2 centre = Vec2::Zero();
  double angle_rad = 0;
  Vec2 half_size = Vec2::Zero();
  double radius_m = 0;
  RingRadii ring_radii = kBestRings;  ///< of kRings only
};

/// One ripple of a surface that is not flat.
struct Wave {
  Vec2 rad_per_m = Vec2::Zero();  ///< along the plane's axes
  double phase_rad = 0;
  double amplitude_m = 0;
};

/// A rectangle of a wall that came after the sheets: a mirror on it, or a door that stands open.
struct WallPatch {
  bool mirror = false;
  double depth_m = 0;                            ///< of an opening: what is behind is dark and so far behind the wall
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();  ///< in the wall's own coordinates

  bool covers(const Vec2& q) const { return (q - low).minCoeff() >= 0 && (high - q).minCoeff() >= 0; }
};

/// A wall, the floor, the ceiling, or a face of a body. Point = origin + q.x axis_u + q.y axis_v, normal = u x v,
/// which points into free space.
struct Plane {
  std::string name;
  Vec3 origin = Vec3::Zero();
  Vec3 axis_u = Vec3::UnitX();
  Vec3 axis_v = Vec3::UnitY();
  Vec3 normal = Vec3::UnitZ();
  Vec2 size = Vec2::Zero();  ///< extent of the plane's own coordinates that matters, m
  double albedo = 0.5;
  double tile_m = 0;     ///< spacing of dark joints; 0 for none
  bool bounded = false;  ///< ends at `size`; else where it meets its neighbours
  std::vector<Decal> decals = {};
  std::vector<Wave> waves = {};         ///< the surface is so far before the plane; they fade towards the plane's ends
  std::vector<WallPatch> patches = {};  ///< of walls only; neither in files nor in shadows

  Vec3 point(const Vec2& q) const { return origin + q.x() * axis_u + q.y() * axis_v; }
  Vec2 coordinates(const Vec3& point_room) const {
    return {(point_room - origin).dot(axis_u), (point_room - origin).dot(axis_v)};
  }
  double signed_distance(const Vec3& point_room) const { return normal.dot(point_room - origin); }
  bool covers(const Vec2& q) const {
    constexpr double kSeam_m = 1e-9;  // neighbours share their edges
    return q.minCoeff() >= -kSeam_m && (size - q).minCoeff() >= -kSeam_m;
  }

  /// Of the surface before the plane, metres; 0 where it is flat. Its derivative by q.
  double height(const Vec2& q) const;
  Vec2 slope(const Vec2& q) const;
  Vec3 surface_point(const Vec2& q) const { return point(q) + height(q) * normal; }
  Vec3 surface_normal(const Vec2& q) const;
};

/// A convex thing in the room (pillar, box): the points on or behind all its planes. It hides and throws shadows.
struct Body {
  std::string name;
  std::vector<Plane> faces;
  /// A ball around it, to pass it by quickly; see planar.h's bound().
  Vec3 centre = Vec3::Zero();
  double reach_m = std::numeric_limits<double>::infinity();
};

/// A rectangular lamp, facing down; zero extent makes it a point with hard shadows.
struct Lamp {
  Vec3 centre = Vec3::Zero();
  Vec2 half_size = Vec2::Zero();  ///< along x and y
  double intensity = 1;           ///< irradiance at 1 m, in front
  bool all_around = false;        ///< shines to every side (a bulb), not by the cosine of a flat panel
};

/// Light that has failed beyond a plane through the room.
struct Darkness {
  Vec3 point_room = Vec3::Zero();
  Vec3 into_dark = Vec3::UnitX();  ///< unit
  double light = 0;                ///< share of it that is left there

  double share_at(const Vec3& point) const;
};

/// Everything that is needed to render. Room frame: origin in a floor corner, x width, y depth, z up, metres.
struct Scene {
  uint64_t seed = 0;
  Vec3 low = Vec3::Zero();  ///< corner of the box around the room
  Vec3 size = Vec3::Zero();
  /// Either all unbounded: a convex room, free space is in front of all of them, floor first, ceiling last. Or all
  /// bounded: any planar layout; seen and hiding from their front only, so a partition has two.
  std::vector<Plane> walls;
  std::vector<Body> bodies;
  std::vector<Lamp> lamps;
  double ambient = 0;                               ///< irradiance from everywhere: what the walls throw back
  std::optional<Darkness> darkness = std::nullopt;  ///< not in files

  bool bounded() const { return !walls.empty() && walls.front().bounded; }
};

/// One ring marker of a scene, as the map knows it.
struct SceneMarker {
  int id = 0;
  Vec3 centre_room = Vec3::Zero();
  Vec3 normal_room = Vec3::UnitZ();
  double radius_m = 0;
};

/// All ring markers, of walls and bodies, in the order of their ids.
std::vector<SceneMarker> markers_of(const Scene& scene);

}  // namespace roomcal::tools
