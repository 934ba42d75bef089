#include "tools/simulate/furniture.h"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "tools/simulate/planar.h"

namespace roomcal::tools {

namespace {

constexpr double kOffWall_m = 0.02;

/// A box of a piece: middle and half size; x along the wall, y away from it, z up from the floor.
struct Part {
  Vec3 middle;
  Vec3 half;
};

std::vector<Part> table(Random& random) {
  const double half = random.uniform(0.4, 0.7), depth = random.uniform(0.25, 0.35), leg = 0.025, height = 0.72;
  std::vector<Part> parts{{{0, depth, height}, {half, depth, 0.015}}};
  for (const double x : {-half + leg, half - leg})
    for (const double y : {leg, 2 * depth - leg}) parts.push_back({{x, y, height / 2}, {leg, leg, height / 2 - 0.02}});
  return parts;
}

std::vector<Part> cabinet(Random& random) {
  const Vec3 half(random.uniform(0.2, 0.4), random.uniform(0.15, 0.25), random.uniform(0.3, 0.6));
  return {{{0, half.y(), half.z() + 0.02}, half}};  // on feet
}

std::vector<Part> shelf(Random& random) {
  const double half = random.uniform(0.3, 0.5), height = random.uniform(1.1, 1.7), depth = 0.12;
  std::vector<Part> parts{{{0, depth, height}, {half, depth, 0.012}}};
  for (const double x : {-0.6 * half, 0.1 * half, 0.7 * half}) {
    const Vec3 thing(random.uniform(0.03, 0.2 * half), 0.08, random.uniform(0.05, 0.14));
    parts.push_back({{x, depth, height + 0.013 + thing.z()}, thing});
  }
  return parts;
}

std::vector<Part> duct(double height_m) { return {{{0, 0.05, height_m / 2}, {0.05, 0.05, height_m / 2 - 0.01}}}; }

/// Middle and radius of a ball around a piece.
std::pair<Vec3, double> ball_around(const std::vector<Body>& piece) {
  Vec3 middle = Vec3::Zero();
  for (const Body& part : piece) middle += part.centre / static_cast<double>(piece.size());
  double radius = 0;
  for (const Body& part : piece) radius = std::max(radius, (part.centre - middle).norm() + part.reach_m);
  return {middle, radius};
}

/// Whether every corner is within the room and before no other wall's rear.
bool inside(const Scene& scene, const Body& part) {
  for (const Vec3& corner : corners_of(part)) {
    if (scene.bounded()) {
      if (!in_free_space(scene, corner)) return false;
      continue;
    }
    for (const Plane& wall : scene.walls)
      if (wall.signed_distance(corner) < 0.005) return false;
  }
  return true;
}

bool fits(const Scene& scene, const std::vector<Body>& piece) {
  const auto [middle, radius] = ball_around(piece);
  for (const Body& part : piece)
    if (!inside(scene, part)) return false;
  for (const Body& other : scene.bodies)
    if (clearance(other, middle) < radius) return false;
  return true;
}

std::vector<Body> stood_at(const Scene& scene, const Plane& wall, double along_m, const std::vector<Part>& parts,
                           double albedo, const std::string& name) {
  const Vec3 away(wall.normal.x(), wall.normal.y(), 0), outwards = away.normalized();
  const Vec3 right = outwards.cross(Vec3::UnitZ());  // with y outwards and z up
  Vec3 foot = wall.point({along_m, 0});
  foot.z() = scene.low.z();
  foot += kOffWall_m * outwards;
  const double yaw_rad = std::atan2(right.y(), right.x());
  std::vector<Body> piece;
  for (const Part& part : parts) {
    const Vec3 middle = foot + part.middle.x() * right + part.middle.y() * outwards + part.middle.z() * Vec3::UnitZ();
    piece.push_back(make_box(name, middle, part.half, yaw_rad, albedo));
  }
  return piece;
}

}  // namespace

void add_furniture(int pieces, Random& random, Scene& scene) {
  constexpr int kTries = 200;
  for (int i = 0; i < pieces; ++i) {
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const Plane& wall = scene.walls[random.below(scene.walls.size())];
      const double along_m = random.uniform(0, wall.size.x()), albedo = random.uniform(0.1, 0.7);
      if (std::abs(wall.normal.z()) > 0.3) continue;
      const std::vector<Part> parts = i % 4 == 0   ? table(random)
                                      : i % 4 == 1 ? cabinet(random)
                                      : i % 4 == 2 ? shelf(random)
                                                   : duct(scene.size.z());
      const std::vector<Body> piece = stood_at(scene, wall, along_m, parts, albedo, fmt::format("furniture{}", i));
      if (!fits(scene, piece)) continue;
      scene.bodies.insert(scene.bodies.end(), piece.begin(), piece.end());
      break;
    }
  }
}

}  // namespace roomcal::tools
