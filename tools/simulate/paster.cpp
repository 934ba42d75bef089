#include "tools/simulate/paster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tools/simulate/planar.h"

namespace roomcal::tools {

namespace {

constexpr double kGap_m = 0.004;     // between sheets
constexpr double kBorder_m = 0.015;  // from a sheet to the end of its wall
constexpr int kTriesPerSheet = 20000;

std::array<Vec2, 4> corners_of(const Decal& decal) {
  const double c = std::cos(decal.angle_rad), s = std::sin(decal.angle_rad);
  const Vec2 across = decal.half_size.x() * Vec2(c, s), up = decal.half_size.y() * Vec2(-s, c);
  return {decal.centre - across - up, decal.centre + across - up, decal.centre + across + up,
          decal.centre - across + up};
}

/// Whether another wall stands in the way: it reaches where the sheet is, and the sheet not wholly before or behind it.
bool cut_by(const Plane& other, const Plane& wall, const Decal& decal) {
  const double around = decal.half_size.norm();
  const Vec2 at = other.coordinates(wall.point(decal.centre));
  if ((at + Vec2::Constant(around)).minCoeff() < 0 || (other.size + Vec2::Constant(around) - at).minCoeff() < 0)
    return false;
  double low = 1e9, high = -1e9;
  for (const Vec2& corner : corners_of(decal)) {
    low = std::min(low, other.signed_distance(wall.point(corner)));
    high = std::max(high, other.signed_distance(wall.point(corner)));
  }
  return low < kBorder_m / 2 && high > -kBorder_m / 2;
}

/// The rectangle around a decal, in its wall's coordinates.
Eigen::AlignedBox2d box_around(const Decal& decal) {
  const double c = std::abs(std::cos(decal.angle_rad)), s = std::abs(std::sin(decal.angle_rad));
  const Vec2 reach(c * decal.half_size.x() + s * decal.half_size.y(),
                   s * decal.half_size.x() + c * decal.half_size.y());
  return {decal.centre - reach, decal.centre + reach};
}

}  // namespace

Paster::Paster(Scene& scene, Random& random, std::vector<KeepOut> keep_out)
    : scene_(scene),
      random_(random),
      keep_out_(std::move(keep_out)),
      walls_(scene.bounded() ? scene.walls.size() : scene.walls.size() - 1) {
  keep_out_.resize(scene.walls.size());
}

bool Paster::paste(Decal decal) {
  for (int attempt = 0; attempt < kTriesPerSheet; ++attempt) {
    const std::size_t wall = random_wall();
    const Vec2& size = scene_.walls[wall].size;
    decal.angle_rad = random_.uniform(-kPi, kPi);
    decal.centre = Vec2(random_.uniform(0, size.x()), random_.uniform(0, size.y()));
    if (!fits(wall, decal)) continue;
    scene_.walls[wall].decals.push_back(decal);
    return true;
  }
  return false;
}

/// By their area.
std::size_t Paster::random_wall() {
  double total = 0;
  for (std::size_t i = 0; i < walls_; ++i) total += scene_.walls[i].size.prod();
  double pick = random_.uniform(0, total);
  for (std::size_t i = 0; i < walls_; ++i) {
    pick -= scene_.walls[i].size.prod();
    if (pick < 0) return i;
  }
  return 0;
}

bool Paster::fits(std::size_t index, const Decal& decal) const {
  const Plane& wall = scene_.walls[index];
  const Eigen::AlignedBox2d around = box_around(decal);
  if ((around.min() - Vec2::Constant(kBorder_m)).minCoeff() < 0) return false;
  if ((wall.size - around.max() - Vec2::Constant(kBorder_m)).minCoeff() < 0) return false;
  for (const Eigen::AlignedBox2d& taken : keep_out_[index])
    if (taken.intersects(around)) return false;
  for (const Body& body : scene_.bodies)
    if (clearance(body, wall.point(decal.centre)) < decal.half_size.norm()) return false;
  for (const Decal& other : wall.decals)
    if (overlap(decal, other, kGap_m)) return false;
  return !wall.bounded || std::none_of(scene_.walls.begin(), scene_.walls.end(), [&](const Plane& other) {
    return &other != &wall && cut_by(other, wall, decal);
  });
}

}  // namespace roomcal::tools
