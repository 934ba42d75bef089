#include "tools/simulate/ray.h"

#include <limits>

namespace roomcal::tools {

Hit cast_at_body(const Body& body, const Vec3& origin, const Vec3& direction) {
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

Hit cast_ray(const Scene& scene, const Vec3& origin, const Vec3& direction) {
  Hit nearest{nullptr, nullptr, std::numeric_limits<double>::infinity()};
  for (const Plane& wall : scene.walls) {
    const double speed = wall.normal.dot(direction);
    if (speed >= 0) continue;
    const double distance = -wall.signed_distance(origin) / speed;
    if (distance < nearest.distance) nearest = {&wall, nullptr, distance};
  }
  for (const Body& body : scene.bodies) {
    const Hit hit = cast_at_body(body, origin, direction);
    if (hit.plane != nullptr && hit.distance < nearest.distance) nearest = hit;
  }
  return nearest;
}

bool is_hidden(const Scene& scene, const Vec3& from, const Vec3& to) {
  constexpr double kNearlyThere = 1 - 1e-9;  // a point on the body's own face is not hidden by it
  for (const Body& body : scene.bodies) {
    const Hit hit = cast_at_body(body, from, to - from);
    if (hit.plane != nullptr && hit.distance < kNearlyThere) return true;
  }
  return false;
}

Mat22 footprint_on(const Plane& plane, const PixelRays& rays, double distance) {
  const double speed = plane.normal.dot(rays.direction);
  Mat22 footprint;
  for (int i = 0; i < 2; ++i) {
    const double slide = -plane.normal.dot(rays.J_px.col(i)) / speed;  // keeps the point on the plane
    const Vec3 step = distance * (rays.J_px.col(i) + slide * rays.direction);
    footprint(0, i) = step.dot(plane.axis_u);
    footprint(1, i) = step.dot(plane.axis_v);
  }
  return footprint;
}

}  // namespace roomcal::tools
