#include "tools/simulate/lidar_sweep.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "tools/common/error.h"
#include "tools/simulate/planar.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/ray.h"

namespace roomcal::tools {

namespace {

constexpr int64_t kTurn_ns = 100'000'000;
constexpr double kBlocker_m = 0.5;

Vec3 direction_lidar(double azimuth_rad, double elevation_rad) {
  const double c = std::cos(elevation_rad);
  return {c * std::sin(azimuth_rad), c * std::cos(azimuth_rad), std::sin(elevation_rad)};
}

/// Range of a beam of some width: a share of its light goes elsewhere.
double mixed_range(const Scene& scene, const Vec3& origin, const Vec3& direction, double divergence_rad, double range_m,
                   Random& random) {
  const Vec3 side = direction.unitOrthogonal();
  const double turn = random.uniform(0, 2 * kPi);
  const Vec3 off = std::cos(turn) * side + std::sin(turn) * direction.cross(side);
  const Hit rim = cast_ray(scene, origin, (direction + 0.5 * divergence_rad * off).normalized());
  if (rim.plane == nullptr || std::abs(rim.distance - range_m) < 0.05) return range_m;
  return std::lerp(range_m, rim.distance, random.uniform());
}

std::vector<Vec3> turned_to(const Vec3& normal, std::vector<Vec3> polygon) {
  Vec3 area = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    area += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
  }
  if (area.dot(normal) < 0) std::reverse(polygon.begin(), polygon.end());
  return polygon;
}

}  // namespace

BeamTable vlp16_beams() {
  BeamTable table;
  for (const int deg : {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15}) {
    table.elevation_rad.push_back(deg_to_rad(deg));
  }
  return table;
}

lidar::Sweep SimulatedSweep::view() const {
  lidar::Sweep sweep;
  sweep.points = points;
  sweep.beam_count = beam_count;
  sweep.duration_ns = duration_ns;
  return sweep;
}

SweepSimulator::SweepSimulator(const Scene& scene) : scene_(scene) {
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

double SweepSimulator::reflectivity(const Plane& plane, const Vec3& origin, const Vec3& direction, double distance_m,
                                    double divergence_rad) const {
  const auto skin = static_cast<std::size_t>(std::find(planes_.begin(), planes_.end(), &plane) - planes_.begin());
  PixelRays rays;  // a "pixel" as wide as the beam
  rays.direction = direction;
  const Vec3 side = direction.unitOrthogonal();
  rays.J_px.col(0) = divergence_rad * side;
  rays.J_px.col(1) = divergence_rad * direction.cross(side);
  const Vec2 q = plane.coordinates(origin + distance_m * direction);
  return 100 * skins_[skin]->at(q, footprint_on(plane, rays, distance_m), 1).albedo;
}

SimulatedSweep SweepSimulator::sweep(const BeamTable& beams, const SweepFlaws& flaws, const SE3& T_room_lidar,
                                     uint64_t seed) const {
  if (beams.elevation_rad.empty() || beams.columns < 1) throw ToolError("a LiDAR needs beams and columns");
  SimulatedSweep sweep;
  sweep.beam_count = static_cast<uint16_t>(beams.elevation_rad.size());
  sweep.duration_ns = kTurn_ns;
  sweep.points.reserve(beams.elevation_rad.size() * static_cast<std::size_t>(beams.columns));
  for (int column = 0; column < beams.columns; ++column) {
    Random random = random_stream(seed, static_cast<uint64_t>(column));
    const double azimuth_rad = 2 * kPi * column / beams.columns;
    const bool blocked = azimuth_rad >= flaws.blocked_from_rad && azimuth_rad < flaws.blocked_to_rad;
    for (std::size_t beam = 0; beam < beams.elevation_rad.size(); ++beam) {
      const Vec3 along = direction_lidar(azimuth_rad, beams.elevation_rad[beam]);
      const Vec3 direction_room = T_room_lidar.R * along;
      const double noise_m = flaws.sigma_m * random.normal();
      const double shade = flaws.reflectivity_sigma * random.normal();
      const Hit hit = cast_ray(scene_, T_room_lidar.t, direction_room);
      if (hit.plane == nullptr || random.uniform() < flaws.dropout) continue;
      double range_m = hit.distance;
      if (flaws.mixed_pixels) {
        range_m = mixed_range(scene_, T_room_lidar.t, direction_room, beams.divergence_rad, range_m, random);
      }
      if (blocked) range_m = kBlocker_m;
      range_m += noise_m + (flaws.beam_offset_m.empty() ? 0.0 : flaws.beam_offset_m.at(beam));
      range_m = std::round(range_m / beams.resolution_m) * beams.resolution_m;
      if (range_m <= 0) continue;
      lidar::SweepPoint point;
      const Vec3 p_lidar = range_m * along;
      point.x_m = static_cast<float>(p_lidar.x());
      point.y_m = static_cast<float>(p_lidar.y());
      point.z_m = static_cast<float>(p_lidar.z());
      point.range_m = static_cast<float>(range_m);
      point.azimuth_rad = static_cast<float>(azimuth_rad);
      point.offset_ns = static_cast<int32_t>(kTurn_ns * column / beams.columns);
      point.beam = static_cast<uint16_t>(beam);
      const double albedo =
          reflectivity(*hit.plane, T_room_lidar.t, direction_room, hit.distance, beams.divergence_rad);
      point.reflectivity = static_cast<uint16_t>(std::clamp(std::lround(albedo + shade), 0L, 100L));
      sweep.points.push_back(point);
    }
  }
  return sweep;
}

std::vector<std::vector<Vec3>> surface_polygons(const Scene& scene) {
  std::vector<std::vector<Vec3>> polygons;
  for (const Plane& wall : scene.walls) polygons.push_back(turned_to(wall.normal, polygon_of(scene, wall)));
  for (const Body& body : scene.bodies) {
    Scene inside;  // a body is a room seen from inside out
    inside.walls = body.faces;
    for (Plane& face : inside.walls) face.normal = -face.normal;
    for (std::size_t i = 0; i < body.faces.size(); ++i) {
      polygons.push_back(turned_to(body.faces[i].normal, polygon_of(inside, inside.walls[i])));
    }
  }
  return polygons;
}

}  // namespace roomcal::tools
