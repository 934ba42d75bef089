#include "tools/simulate/scene.h"

#include <algorithm>
#include <cmath>

namespace roomcal::tools {

namespace {

/// 0 at an end of the plane, 1 from kFade_m on; and its derivative by the distance from the end.
struct Fade {
  double value = 1, slope = 0;
};
Fade fade(double from_end_m) {
  constexpr double kFade_m = 0.3;
  const double t = std::clamp(from_end_m / kFade_m, 0.0, 1.0);
  return {t * t * (3 - 2 * t), 6 * t * (1 - t) / kFade_m};
}

/// Of both ends of an axis.
Fade fade(double at_m, double size_m) {
  const Fade low = fade(at_m), high = fade(size_m - at_m);
  return {low.value * high.value, low.slope * high.value - low.value * high.slope};
}

}  // namespace

double Plane::height(const Vec2& q) const {
  if (waves.empty()) return 0;
  double sum = 0;
  for (const Wave& wave : waves) sum += wave.amplitude_m * std::sin(wave.rad_per_m.dot(q) + wave.phase_rad);
  return sum * fade(q.x(), size.x()).value * fade(q.y(), size.y()).value;
}

Vec2 Plane::slope(const Vec2& q) const {
  double sum = 0;
  Vec2 rise = Vec2::Zero();
  for (const Wave& wave : waves) {
    const double phase = wave.rad_per_m.dot(q) + wave.phase_rad;
    sum += wave.amplitude_m * std::sin(phase);
    rise += wave.amplitude_m * std::cos(phase) * wave.rad_per_m;
  }
  const Fade across = fade(q.x(), size.x()), up = fade(q.y(), size.y());
  return across.value * up.value * rise + sum * Vec2(across.slope * up.value, across.value * up.slope);
}

Vec3 Plane::surface_normal(const Vec2& q) const {
  if (waves.empty()) return normal;
  const Vec2 rise = slope(q);
  return (normal - rise.x() * axis_u - rise.y() * axis_v).normalized();
}

double Darkness::share_at(const Vec3& point) const {
  constexpr double kEdge_m = 0.2;  // lamps are no points
  return std::lerp(1.0, light, std::clamp(into_dark.dot(point - point_room) / kEdge_m, 0.0, 1.0));
}

std::vector<SceneMarker> markers_of(const Scene& scene) {
  std::vector<SceneMarker> markers;
  const auto add = [&](const Plane& plane) {
    for (const Decal& decal : plane.decals) {
      if (decal.print != Print::kRings) continue;
      markers.push_back(
          {decal.marker_id, plane.surface_point(decal.centre), plane.surface_normal(decal.centre), decal.radius_m});
    }
  };
  for (const Plane& wall : scene.walls) add(wall);
  for (const Body& body : scene.bodies)
    for (const Plane& face : body.faces) add(face);
  std::sort(markers.begin(), markers.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return markers;
}

}  // namespace roomcal::tools
