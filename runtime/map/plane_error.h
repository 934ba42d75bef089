#pragma once

#include <Eigen/Geometry>

#include "runtime/math/types.h"

namespace roomcal::map {

/// Two unit axes u, v in a plane, u x v = normal; the same wherever the same normal is.
inline Mat32 plane_axes(const Vec3& normal_room) {
  Eigen::Index least = 0;
  normal_room.cwiseAbs().minCoeff(&least);
  const Vec3 u = (Vec3::Unit(least) - normal_room[least] * normal_room).normalized();
  Mat32 axes;
  axes << u, normal_room.cross(u);
  return axes;
}

/// A plane of the map may be off by delta = (offset [m], tilt along u, tilt along v [rad]): the true plane's signed
/// distance of a point p is the map's plus plane_lever(normal, p) . delta, with the lever (1, u . p, v . p).
inline Vec3 plane_lever(const Vec3& normal_room, const Vec3& p_room) {
  const Vec2 in_plane = plane_axes(normal_room).transpose() * p_room;
  return {1, in_plane.x(), in_plane.y()};
}

}  // namespace roomcal::map
