#include "tools/simulate/ray.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace roomcal::tools {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// False if the ray certainly passes the body by.
bool may_meet(const Body& body, const Vec3& origin, const Vec3& direction) {
  if (body.reach_m == kNever) return true;
  const Vec3 to_centre = body.centre - origin;
  const double along = std::max(0.0, to_centre.dot(direction) / direction.squaredNorm());
  return (to_centre - along * direction).squaredNorm() <= body.reach_m * body.reach_m;
}

/// As if there were no waves.
double flat_distance_to(const Plane& plane, const Vec3& origin, const Vec3& direction) {
  const double speed = plane.normal.dot(direction);
  if (speed >= 0) return kNever;
  const double distance = -plane.signed_distance(origin) / speed;
  if (!plane.bounded) return distance;
  const bool met = distance > 0 && plane.covers(plane.coordinates(origin + distance * direction));
  return met ? distance : kNever;
}

/// From the plane to its surface, by Newton's method: waves are low and long, one slope does for all steps.
double settle(const Plane& plane, const Vec3& origin, const Vec3& direction, double distance) {
  if (plane.waves.empty() || distance == kNever) return distance;
  constexpr int kMostSteps = 8;
  constexpr double kEnough_m = 1e-9;
  const Vec2 slide(direction.dot(plane.axis_u), direction.dot(plane.axis_v));
  double closing = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3 point_room = origin + distance * direction;
    const Vec2 q = plane.coordinates(point_room);
    if (step == 0) closing = plane.normal.dot(direction) - plane.slope(q).dot(slide);
    if (closing >= 0) return kNever;  // grazes a ripple
    const double gap_m = plane.signed_distance(point_room) - plane.height(q);
    distance -= gap_m / closing;
    if (std::abs(gap_m) < kEnough_m) break;
  }
  return distance;
}

/// Waves reach so far from their plane at most, a look from the side included.
constexpr double kWavesReach_m = 0.3;

}  // namespace

double distance_to(const Plane& plane, const Vec3& origin, const Vec3& direction) {
  return settle(plane, origin, direction, flat_distance_to(plane, origin, direction));
}

Hit cast_at_body(const Body& body, const Vec3& origin, const Vec3& direction) {
  if (!may_meet(body, origin, direction)) return {};
  Hit enter{nullptr, &body, -std::numeric_limits<double>::infinity()};
  double leave = std::numeric_limits<double>::infinity();
  for (const Plane& face : body.faces) {
    const double speed = face.normal.dot(direction);
    const double height = face.signed_distance(origin);
    if (speed < 0) {
      const double distance = -height / speed;
      if (distance > enter.distance) enter = {&face, &body, distance};
    } else if (speed > 0) {
      leave = std::min(leave, -height / speed);
    } else if (height > 0) {
      return {};
    }
  }
  return enter.plane != nullptr && enter.distance > 0 && enter.distance < leave ? enter : Hit{};
}

namespace {

Hit nearer_body(const Scene& scene, const Vec3& origin, const Vec3& direction, Hit nearest) {
  for (const Body& body : scene.bodies) {
    const Hit hit = cast_at_body(body, origin, direction);
    if (hit.plane != nullptr && hit.distance < nearest.distance) nearest = hit;
  }
  return nearest;
}

}  // namespace

Hit cast_ray(const Scene& scene, const Vec3& origin, const Vec3& direction) {
  Hit nearest{nullptr, nullptr, kNever};
  for (const Plane& wall : scene.walls) {
    const double flat = flat_distance_to(wall, origin, direction);
    if (flat >= nearest.distance + (wall.waves.empty() ? 0 : kWavesReach_m)) continue;
    const double distance = settle(wall, origin, direction, flat);
    if (distance < nearest.distance) nearest = {&wall, nullptr, distance};
  }
  return nearer_body(scene, origin, direction, nearest);
}

Vec3 mirrored(const Plane& plane, const Vec3& point_room) {
  return point_room - 2 * plane.signed_distance(point_room) * plane.normal;
}

Sight look(const Scene& scene, const Vec3& eye_room, const PixelRays& rays) {
  Sight sight{eye_room, rays, cast_ray(scene, eye_room, rays.direction)};
  if (sight.hit.plane == nullptr || sight.hit.plane->patches.empty()) return sight;
  const Plane& wall = *sight.hit.plane;
  const Vec3 point_room = eye_room + sight.hit.distance * rays.direction;
  const auto patch = std::find_if(wall.patches.begin(), wall.patches.end(),
                                  [&](const WallPatch& one) { return one.covers(wall.coordinates(point_room)); });
  if (patch == wall.patches.end()) return sight;
  sight.patch = &*patch;
  if (!patch->mirror) {
    sight.hit.distance -= patch->depth_m / wall.normal.dot(rays.direction);
    return sight;
  }
  const Mat33 turn = Mat33::Identity() - 2 * wall.normal * wall.normal.transpose();
  sight.eye_room = mirrored(wall, eye_room);
  sight.rays = {turn * rays.direction, turn * rays.J_px};
  const double to_mirror = sight.hit.distance;
  sight.hit = cast_ray(scene, point_room, sight.rays.direction);
  sight.hit.distance += to_mirror;
  return sight;
}

Hit cast_flat(const Scene& scene, const Vec3& origin, const Vec3& direction) {
  Hit nearest{nullptr, nullptr, kNever};
  for (const Plane& wall : scene.walls) {
    const double distance = flat_distance_to(wall, origin, direction);
    if (distance < nearest.distance) nearest = {&wall, nullptr, distance};
  }
  return nearer_body(scene, origin, direction, nearest);
}

bool is_hidden(const Scene& scene, const Vec3& from, const Vec3& to) {
  constexpr double kNearlyThere = 1 - 1e-9;  // a point on the body's own face is not hidden by it
  for (const Body& body : scene.bodies) {
    const Hit hit = cast_at_body(body, from, to - from);
    if (hit.plane != nullptr && hit.distance < kNearlyThere) return true;
  }
  if (!scene.bounded()) return false;
  constexpr double kOnWall_m = 0.02;  // what is glued to a wall is not hidden by its waves
  return std::any_of(scene.walls.begin(), scene.walls.end(), [&](const Plane& wall) {
    return wall.signed_distance(to) < -kOnWall_m && flat_distance_to(wall, from, to - from) < 1;
  });
}

Tangent tangent_at(const Plane& plane, const Vec2& q) {
  if (plane.waves.empty()) return {plane.origin, plane.normal};
  return {plane.surface_point(q), plane.surface_normal(q)};
}

Mat22 footprint_on(const Plane& plane, const Vec3& normal_room, const PixelRays& rays, double distance) {
  const double speed = normal_room.dot(rays.direction);
  Mat22 footprint;
  for (int i = 0; i < 2; ++i) {
    const double slide = -normal_room.dot(rays.J_px.col(i)) / speed;  // keeps the point on the surface
    const Vec3 step = distance * (rays.J_px.col(i) + slide * rays.direction);
    footprint(0, i) = step.dot(plane.axis_u);
    footprint(1, i) = step.dot(plane.axis_v);
  }
  return footprint;
}

}  // namespace roomcal::tools
