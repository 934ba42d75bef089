#include "tools/sweep/wall_offsets.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tools/common/error.h"
#include "tools/common/random.h"

namespace roomcal::tools {

namespace {

constexpr double kFind_m = 0.05;  // a point this near belongs to a wall while looking for walls
constexpr double kGate_m = 0.08;  // along the ray, while fitting: five sigma of the worst sensor seen
constexpr double kMinCosine = 0.5;
constexpr std::size_t kMaxWalls = 3, kFindPoints = 6000, kTrials = 600, kRounds = 6;
constexpr std::size_t kMinBeamPoints = 10;  // of one beam in one sweep

struct Ray {
  Vec3 direction_lidar;
  Vec3 origin_lidar;  ///< direction * range + origin = point
  double range_m = 0;
  std::size_t beam = 0, sweep = 0;
  int wall = -1;

  Vec3 point() const { return origin_lidar + range_m * direction_lidar; }
};

std::vector<Ray> rays_of(const Recording& recording) {
  std::vector<Ray> rays;
  for (std::size_t s = 0; s < recording.sweeps.size(); ++s) {
    const lidar::Sweep sweep = recording.sweeps[s].view();
    if ((sweep.flags & lidar::kSweepPartial) != 0) continue;
    for (std::size_t i = 0; i < sweep.points.size(); ++i) {
      const Vec3 p = sweep.position_lidar(i);
      if (p.norm() < 0.2) continue;
      // The beams' origins are within centimetres of the axis; for residuals of millimetres the ray is through the
      // origin.
      rays.push_back({p.normalized(), Vec3::Zero(), p.norm(), sweep.points[i].beam, s, -1});
    }
  }
  return rays;
}

bool plane_through(const Vec3& a, const Vec3& b, const Vec3& c, SeenWall& wall) {
  const Vec3 normal = (b - a).cross(c - a);
  if (normal.norm() < 1e-3) return false;
  wall.normal_lidar = normal.normalized();
  wall.distance_m = wall.normal_lidar.dot(a);
  if (wall.distance_m < 0) {
    wall.distance_m = -wall.distance_m;
    wall.normal_lidar = -wall.normal_lidar;
  }
  return wall.distance_m > 0.1;
}

/// On the plane, and seen under an angle that tells its distance.
bool facing(const SeenWall& wall, const Vec3& p) {
  const double along = wall.normal_lidar.dot(p);
  return std::abs(along - wall.distance_m) < kFind_m && along > kMinCosine * p.norm();
}

/// The plane with most points among the rays that no wall has yet.
SeenWall largest_plane(const std::vector<Vec3>& points, Random& random) {
  SeenWall best;
  if (points.size() < 3) return best;
  for (std::size_t trial = 0; trial < kTrials; ++trial) {
    SeenWall wall;
    if (!plane_through(points[random.below(points.size())], points[random.below(points.size())],
                       points[random.below(points.size())], wall))
      continue;
    for (const Vec3& p : points) wall.points += facing(wall, p);
    if (wall.points > best.points) best = wall;
  }
  return best;
}

/// Range that the wall has along a ray.
double wall_range_m(const SeenWall& wall, const Ray& ray) {
  return wall.distance_m / wall.normal_lidar.dot(ray.direction_lidar);
}

bool on_wall(const SeenWall& wall, const Ray& ray, double offset_m) {
  return wall.normal_lidar.dot(ray.direction_lidar) > kMinCosine &&
         std::abs(ray.range_m - offset_m - wall_range_m(wall, ray)) < kGate_m;
}

void assign(std::vector<Ray>& rays, const std::vector<SeenWall>& walls, const std::vector<double>& offset_m) {
  for (Ray& ray : rays) {
    ray.wall = -1;
    double nearest = kGate_m;
    for (std::size_t w = 0; w < walls.size(); ++w) {
      if (!on_wall(walls[w], ray, offset_m[ray.beam])) continue;
      const double residual = std::abs(ray.range_m - offset_m[ray.beam] - wall_range_m(walls[w], ray));
      if (residual > nearest) continue;
      nearest = residual;
      ray.wall = static_cast<int>(w);
    }
  }
}

/// One Gauss-Newton step of the walls given the offsets: plane as vector m = n / d, so that 1 / (m . direction) is the
/// range.
void refit_walls(const std::vector<Ray>& rays, const std::vector<double>& offset_m, std::vector<SeenWall>& walls) {
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const Vec3 m = walls[w].normal_lidar / walls[w].distance_m;
    Mat33 H = Mat33::Zero();
    Vec3 g = Vec3::Zero();
    walls[w].points = 0;
    for (const Ray& ray : rays) {
      if (ray.wall != static_cast<int>(w)) continue;
      const double range = 1 / m.dot(ray.direction_lidar);
      const Vec3 J = -range * range * ray.direction_lidar;
      H += J * J.transpose();
      g += J * (ray.range_m - offset_m[ray.beam] - range);
      ++walls[w].points;
    }
    if (walls[w].points < 100) continue;
    const Vec3 better = m + H.ldlt().solve(g);
    walls[w].normal_lidar = better.normalized();
    walls[w].distance_m = 1 / better.norm();
  }
}

void refit_offsets(const std::vector<Ray>& rays, const std::vector<SeenWall>& walls, std::vector<double>& offset_m) {
  std::vector<double> sum(offset_m.size()), count(offset_m.size());
  for (const Ray& ray : rays) {
    if (ray.wall < 0) continue;
    sum[ray.beam] += ray.range_m - wall_range_m(walls[static_cast<std::size_t>(ray.wall)], ray);
    count[ray.beam] += 1;
  }
  double mean = 0, beams = 0;
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (count[i] == 0) continue;
    offset_m[i] = sum[i] / count[i];
    mean += offset_m[i];
    beams += 1;
  }
  for (std::size_t i = 0; i < sum.size(); ++i) offset_m[i] = count[i] == 0 ? 0 : offset_m[i] - mean / beams;
}

std::vector<SeenWall> find_walls(const std::vector<Ray>& rays) {
  Random random(1);
  std::vector<Vec3> points;
  const std::size_t stride = std::max<std::size_t>(1, rays.size() / kFindPoints);
  for (std::size_t i = 0; i < rays.size(); i += stride) points.push_back(rays[i].point());
  const std::size_t least = std::max<std::size_t>(100, points.size() / 10);
  std::vector<SeenWall> walls;
  while (walls.size() < kMaxWalls) {
    const SeenWall wall = largest_plane(points, random);
    if (wall.points < least) break;
    walls.push_back(wall);
    std::erase_if(points,
                  [&](const Vec3& p) { return std::abs(wall.normal_lidar.dot(p) - wall.distance_m) < 2 * kFind_m; });
  }
  return walls;
}

/// Residuals of a beam, sweep by sweep.
BeamOffset beam_facts(const std::vector<Ray>& rays, const std::vector<SeenWall>& walls, std::size_t beam,
                      std::size_t sweeps) {
  std::vector<std::vector<double>> residuals(sweeps);
  for (const Ray& ray : rays)
    if (ray.beam == beam && ray.wall >= 0)
      residuals[ray.sweep].push_back(ray.range_m - wall_range_m(walls[static_cast<std::size_t>(ray.wall)], ray));
  BeamOffset result;
  result.beam = beam;
  double sum = 0, squares = 0, noise = 0;
  for (const std::vector<double>& sweep : residuals) {
    if (sweep.size() < kMinBeamPoints) continue;
    double mean = 0, square = 0;
    for (const double r : sweep) mean += r / static_cast<double>(sweep.size());
    for (const double r : sweep) square += (r - mean) * (r - mean);
    result.points += sweep.size();
    ++result.sweeps;
    sum += mean;
    squares += mean * mean;
    noise += std::sqrt(square / static_cast<double>(sweep.size() - 1));
  }
  if (result.sweeps == 0) return result;
  const auto n = static_cast<double>(result.sweeps);
  result.mean_mm = 1e3 * sum / n;
  result.spread_mm = n < 2 ? 0 : 1e3 * std::sqrt(std::max(0.0, (squares - sum * sum / n) / (n - 1)));
  result.noise_mm = 1e3 * noise / n;
  return result;
}

}  // namespace

WallOffsets wall_offsets(const Recording& recording) {
  WallOffsets result;
  std::vector<Ray> rays = rays_of(recording);
  result.walls = find_walls(rays);
  if (result.walls.empty()) throw ToolError("--walls: the sweeps see no flat wall; point the sensor at one");
  std::size_t beams = 0;
  for (const LoadedSweep& sweep : recording.sweeps) beams = std::max<std::size_t>(beams, sweep.facts.beam_count);
  std::vector<double> offset_m(beams, 0.0);
  for (std::size_t round = 0; round < kRounds; ++round) {
    assign(rays, result.walls, offset_m);
    refit_walls(rays, offset_m, result.walls);
    refit_offsets(rays, result.walls, offset_m);
  }
  double squares = 0;
  const auto whole = static_cast<std::size_t>(
      std::count_if(recording.sweeps.begin(), recording.sweeps.end(),
                    [](const LoadedSweep& sweep) { return (sweep.facts.flags & lidar::kSweepPartial) == 0; }));
  for (std::size_t beam = 0; beam < beams; ++beam) {
    const BeamOffset facts = beam_facts(rays, result.walls, beam, recording.sweeps.size());
    if (facts.sweeps == 0 || facts.sweeps * 2 < whole) continue;
    result.beams.push_back(facts);
    squares += facts.mean_mm * facts.mean_mm;
  }
  result.rms_mm = result.beams.empty() ? 0 : std::sqrt(squares / static_cast<double>(result.beams.size()));
  return result;
}

void print_wall_offsets(const WallOffsets& offsets) {
  for (const SeenWall& wall : offsets.walls) {
    fmt::print("  wall: normal {:.4f} {:.4f} {:.4f}, {:.3f} m away, {} points\n", wall.normal_lidar.x(),
               wall.normal_lidar.y(), wall.normal_lidar.z(), wall.distance_m, wall.points);
  }
  fmt::print("  beam offset_mm spread_over_sweeps_mm noise_mm  points sweeps\n");
  for (const BeamOffset& beam : offsets.beams) {
    fmt::print("  {:4} {:9.2f} {:21.2f} {:8.2f} {:7} {:6}\n", beam.beam, beam.mean_mm, beam.spread_mm, beam.noise_mm,
               beam.points, beam.sweeps);
  }
  fmt::print("  rms of the offsets: {:.2f} mm\n", offsets.rms_mm);
}

nlohmann::json to_json(const WallOffsets& offsets) {
  nlohmann::json walls = nlohmann::json::array(), beams = nlohmann::json::array();
  for (const SeenWall& wall : offsets.walls) {
    const Vec3& n = wall.normal_lidar;
    walls.push_back(
        {{"normal_lidar", {n.x(), n.y(), n.z()}}, {"distance_m", wall.distance_m}, {"points", wall.points}});
  }
  for (const BeamOffset& beam : offsets.beams) {
    beams.push_back({{"beam", beam.beam},
                     {"offset_mm", beam.mean_mm},
                     {"spread_over_sweeps_mm", beam.spread_mm},
                     {"noise_mm", beam.noise_mm},
                     {"points", beam.points},
                     {"sweeps", beam.sweeps}});
  }
  return {{"walls", walls}, {"beams", beams}, {"rms_mm", offsets.rms_mm}};
}

}  // namespace roomcal::tools
