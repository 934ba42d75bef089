#include "tools/simulate/room_walls.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/simulate/planar.h"

namespace roomcal::tools {

namespace {

constexpr double kLean_rad = deg_to_rad(0.25);  // sigma of a wall's lean
constexpr double kWallAlbedo = 0.42, kFloorAlbedo = 0.28, kCeilingAlbedo = 0.6, kTile_m = 0.6;

Plane plane_of(const Wall& wall) {
  Plane plane;
  plane.name = wall.name;
  plane.origin = wall.corner_room;
  plane.axis_u = wall.right_room;
  plane.axis_v = wall.up_room;
  plane.normal = wall.normal_room();
  plane.size = wall.size_m;
  plane.bounded = true;
  const bool floor = plane.normal.z() > 0.7, ceiling = plane.normal.z() < -0.7;
  plane.albedo = floor ? kFloorAlbedo : ceiling ? kCeilingAlbedo : kWallAlbedo;
  plane.tile_m = floor ? kTile_m : 0;
  return plane;
}

double distance_to_walls(const Scene& scene, const Vec3& p_room) {
  double least_m = 1e9;
  for (const Plane& wall : scene.walls) {
    const Vec2 nearest = wall.coordinates(p_room).cwiseMax(Vec2::Zero()).cwiseMin(wall.size);
    least_m = std::min(least_m, (wall.point(nearest) - p_room).norm());
  }
  for (const Body& body : scene.bodies) least_m = std::min(least_m, clearance(body, p_room));
  return least_m;
}

}  // namespace

void build_box(const Vec3& size_m, Random& random, Scene& scene) {
  const auto leaning = [&](const Vec3& normal) {
    return Vec3(normal + kLean_rad * Vec3(random.normal(), random.normal(), random.normal()));
  };
  const Vec3 far = size_m;
  scene.size = size_m;
  scene.walls = {make_plane("floor", Vec3::Zero(), Vec3::UnitZ(), kFloorAlbedo),
                 make_plane("wall_x0", Vec3::Zero(), leaning(Vec3::UnitX()), kWallAlbedo),
                 make_plane("wall_y0", Vec3::Zero(), leaning(Vec3::UnitY()), kWallAlbedo),
                 make_plane("wall_x1", Vec3(far.x(), far.y(), 0), leaning(-Vec3::UnitX()), kWallAlbedo),
                 make_plane("wall_y1", Vec3(far.x(), far.y(), 0), leaning(-Vec3::UnitY()), kWallAlbedo),
                 make_plane("ceiling", far, -Vec3::UnitZ(), kCeilingAlbedo)};
  scene.walls.front().tile_m = kTile_m;
  for (Plane& wall : scene.walls) {  // coordinates start at the lower left corner
    Vec2 low = Vec2::Constant(1e9), high = Vec2::Constant(-1e9);
    for (const Vec3& corner : polygon_of(scene, wall)) {
      low = low.cwiseMin(wall.coordinates(corner));
      high = high.cwiseMax(wall.coordinates(corner));
    }
    wall.origin = wall.point(low);
    wall.size = high - low;
  }
}

void build_drawn_walls(const std::vector<Wall>& walls, Scene& scene) {
  if (walls.size() < 3) throw ToolError("--walls: a room to stand in wants three walls at least, the floor included");
  Vec3 high = Vec3::Constant(-1e9);
  scene.low = Vec3::Constant(1e9);
  for (const Wall& wall : walls) {
    scene.walls.push_back(plane_of(wall));
    for (const Vec3& corner : polygon_of(scene, scene.walls.back())) {
      scene.low = scene.low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  scene.size = high - scene.low;
}

void add_waves(double sigma_m, Random& random, Scene& scene) {
  constexpr int kWaves = 4;
  for (Plane& wall : scene.walls) {
    for (int i = 0; i < kWaves && sigma_m > 0; ++i) {
      const double length_m = random.uniform(0.8, 3), turn = random.uniform(0, 2 * kPi);
      wall.waves.push_back({2 * kPi / length_m * Vec2(std::cos(turn), std::sin(turn)), random.uniform(0, 2 * kPi),
                            sigma_m * std::sqrt(2.0 / kWaves)});
    }
  }
}

Waviness waviness_of(const Plane& wall) {
  constexpr int kSteps = 100;
  Waviness waviness;
  double squares = 0;
  for (int i = 0; i < kSteps * kSteps && !wall.waves.empty(); ++i) {
    const double height = wall.height(Vec2(i % kSteps + 0.5, i / kSteps + 0.5).cwiseProduct(wall.size) / kSteps);
    squares += height * height / (kSteps * kSteps);
    waviness.max_m = std::max(waviness.max_m, std::abs(height));
  }
  waviness.sigma_m = std::sqrt(squares);
  return waviness;
}

Vec3 draw_free_place(const Scene& scene, double height_m, double off_m, Random& random) {
  constexpr int kTries = 5000;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Vec3 share(random.uniform(), random.uniform(), height_m / scene.size.z());
    const Vec3 place = scene.low + share.cwiseProduct(scene.size);
    if (distance_to_walls(scene, place) > off_m && in_free_space(scene, place)) return place;
  }
  throw ToolError(
      fmt::format("room: no place {} m above its floor and {} m off everything; are its walls drawn as seen from "
                  "inside, and is it empty "
                  "enough?",
                  height_m, off_m));
}

}  // namespace roomcal::tools
