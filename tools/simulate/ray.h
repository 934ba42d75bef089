#pragma once

#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// A bundle of rays through one pixel: the central direction and how it turns per pixel.
struct PixelRays {
  Vec3 direction = Vec3::UnitZ();
  Mat32 J_px = Mat32::Zero();

  Vec3 at(double dx_px, double dy_px) const { return direction + J_px.col(0) * dx_px + J_px.col(1) * dy_px; }
};

/// Where a ray meets the scene. `plane` is null for a ray that leaves it.
struct Hit {
  const Plane* plane = nullptr;
  const Body* body = nullptr;  ///< null for the room itself
  double distance = 0;         ///< in lengths of the direction
};

/// Nearest surface along origin + distance * direction, from inside the room. No plane where the room is open.
/// Cost: a division per plane.
Hit cast_ray(const Scene& scene, const Vec3& origin, const Vec3& direction);

/// A look into the scene. What a mirror shows is where a straight look from the eye's image finds it: eye and rays
/// turn with it, and distances count from there.
struct Sight {
  Vec3 eye_room = Vec3::Zero();
  PixelRays rays;
  Hit hit;
  const WallPatch* patch = nullptr;  ///< the first one met; if it is an opening, the hit is so far behind the wall
};
Sight look(const Scene& scene, const Vec3& eye_room, const PixelRays& rays);

/// The image of a point behind a plane.
Vec3 mirrored(const Plane& plane, const Vec3& point_room);

/// The same as if nothing had waves: for what is seen where, not for how far it is.
Hit cast_flat(const Scene& scene, const Vec3& origin, const Vec3& direction);

/// The face by which a ray enters the body, or null.
Hit cast_at_body(const Body& body, const Vec3& origin, const Vec3& direction);

/// Distance, in lengths of the direction, at which a ray meets a plane's surface from its front; infinite if never.
double distance_to(const Plane& plane, const Vec3& origin, const Vec3& direction);

/// Whether a body, or a wall of a room that is not convex, stands between two points.
bool is_hidden(const Scene& scene, const Vec3& from, const Vec3& to);

/// The flat piece of surface around a hit.
struct Tangent {
  Vec3 point_room = Vec3::Zero();
  Vec3 normal_room = Vec3::UnitZ();

  double distance(const Vec3& origin, const Vec3& direction) const {
    return -normal_room.dot(origin - point_room) / normal_room.dot(direction);
  }
};
Tangent tangent_at(const Plane& plane, const Vec2& q);

/// Derivative of the hit's plane coordinates by pixel (2x2, m per px).
/// @param normal_room  of the surface there
Mat22 footprint_on(const Plane& plane, const Vec3& normal_room, const PixelRays& rays, double distance);

}  // namespace roomcal::tools
