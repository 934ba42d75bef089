#include "tools/simulate/lidar_sweep.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "tools/common/error.h"
#include "tools/simulate/planar.h"
#include "tools/simulate/random_stream.h"

namespace roomcal::tools {

namespace {

constexpr int64_t kTurn_ns = 100'000'000;

Vec3 direction_lidar(double azimuth_rad, double elevation_rad) {
  const double c = std::cos(elevation_rad);
  return {c * std::sin(azimuth_rad), c * std::cos(azimuth_rad), std::sin(elevation_rad)};
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
      const double offset_m = flaws.beam_offset_m.empty() ? 0.0 : flaws.beam_offset_m.at(beam);
      const Echo echo = caster_.echo({T_room_lidar.t, T_room_lidar.R * along, beams.divergence_rad, offset_m, blocked},
                                     flaws, random);
      const double range_m = std::round(echo.range_m / beams.resolution_m) * beams.resolution_m;
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
      point.reflectivity = static_cast<uint16_t>(std::lround(echo.reflectivity_percent));
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
