#include "tools/simulate/echo.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "tools/simulate/ray.h"

namespace roomcal::tools {

namespace {
constexpr double kBlocker_m = 0.5;
constexpr double kSameSurface_m = 0.05;
}  // namespace

EchoCaster::EchoCaster(const Scene& scene) : scene_(scene) {
  uint64_t seed = scene.seed;
  const auto add = [&](const Plane& plane) {
    planes_.push_back(&plane);
    skins_.push_back(std::make_unique<PaintedPlane>(plane, seed += 2));
  };
  for (const Plane& wall : scene.walls) add(wall);
  for (const Body& body : scene.bodies) {
    for (const Plane& face : body.faces) add(face);
  }
}

/// A share of the light goes elsewhere.
double EchoCaster::mixed_range_m(const Pulse& pulse, double range_m, Random& random) const {
  const Vec3 side = pulse.direction_room.unitOrthogonal();
  const double turn = random.uniform(0, 2 * kPi);
  const Vec3 off = std::cos(turn) * side + std::sin(turn) * pulse.direction_room.cross(side);
  const Hit rim =
      cast_ray(scene_, pulse.origin_room, (pulse.direction_room + 0.5 * pulse.divergence_rad * off).normalized());
  if (rim.plane == nullptr || std::abs(rim.distance - range_m) < kSameSurface_m) return range_m;
  return std::lerp(range_m, rim.distance, random.uniform());
}

double EchoCaster::reflectivity_percent(const Plane& plane, const Pulse& pulse, double distance_m) const {
  const auto skin = static_cast<std::size_t>(std::find(planes_.begin(), planes_.end(), &plane) - planes_.begin());
  PixelRays rays;  // a "pixel" as wide as the beam
  rays.direction = pulse.direction_room;
  const Vec3 side = pulse.direction_room.unitOrthogonal();
  rays.J_px.col(0) = pulse.divergence_rad * side;
  rays.J_px.col(1) = pulse.divergence_rad * pulse.direction_room.cross(side);
  const Vec2 q = plane.coordinates(pulse.origin_room + distance_m * pulse.direction_room);
  return 100 *
         PaintPatch(*skins_[skin], q, footprint_on(plane, plane.surface_normal(q), rays, distance_m)).at(q, 1).albedo;
}

Echo EchoCaster::echo(const Pulse& pulse, const RangeFlaws& flaws, Random& random) const {
  const double noise_m = flaws.sigma_m * random.normal();
  const double shade = flaws.reflectivity_sigma * random.normal();
  const Sight sight = look(scene_, pulse.origin_room, {pulse.direction_room, Mat32::Zero()});
  const Hit& hit = sight.hit;
  if (hit.plane == nullptr || random.uniform() < flaws.dropout) return {};
  Echo echo;
  echo.range_m = hit.distance;
  if (flaws.mixed_pixels) echo.range_m = mixed_range_m(pulse, echo.range_m, random);
  if (pulse.blocked) echo.range_m = kBlocker_m;
  echo.range_m = std::max(0.0, echo.range_m + (noise_m + pulse.offset_m));
  Pulse arriving = pulse;  // as if from the pulse's image behind a mirror
  arriving.origin_room = sight.eye_room;
  arriving.direction_room = sight.rays.direction;
  echo.reflectivity_percent = std::clamp(reflectivity_percent(*hit.plane, arriving, hit.distance) + shade, 0.0, 100.0);
  return echo;
}

}  // namespace roomcal::tools
