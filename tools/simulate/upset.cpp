#include "tools/simulate/upset.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "tools/simulate/planar.h"

namespace roomcal::tools {

namespace {

constexpr double kUpright = 0.3;  // |normal.z| below it

Plane& draw_wall(Random& random, Scene& scene) {
  for (;;) {
    Plane& wall = scene.walls[random.below(scene.walls.size())];
    if (std::abs(wall.normal.z()) < kUpright) return wall;
  }
}

/// Whether a sheet lies within the patch as a whole, not at all, or across its rim.
enum class Lies { kWithin, kBeside, kAcross };
Lies lies(const Decal& decal, const WallPatch& patch) {
  int inside = 0;
  constexpr int kAlong = 5;  // places a side
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAlong; ++j) {
      const Vec2 share(2.0 * i / (kAlong - 1) - 1, 2.0 * j / (kAlong - 1) - 1);
      inside += patch.covers(decal.centre + Eigen::Rotation2Dd(decal.angle_rad) * share.cwiseProduct(decal.half_size));
    }
  }
  return inside == 0 ? Lies::kBeside : inside == kAlong * kAlong ? Lies::kWithin : Lies::kAcross;
}

/// Takes the sheets off a patch. @return those that lay within it
std::vector<Decal> clear(Plane& wall, const WallPatch& patch) {
  std::vector<Decal> kept, taken;
  for (const Decal& decal : wall.decals) {
    const Lies where = lies(decal, patch);
    if (where == Lies::kBeside) kept.push_back(decal);
    if (where == Lies::kWithin) taken.push_back(decal);
  }
  wall.decals = std::move(kept);
  return taken;
}

/// A door's leaf: the patch of its wall, turned about its hinge, the sheets on it.
Body leaf_of(const Plane& wall, const WallPatch& door, double opened_rad, const std::vector<Decal>& sheets) {
  constexpr double kHalfThickness_m = 0.02;
  const Vec2 half = (door.high - door.low) / 2;
  const Vec3 hinge = wall.point({door.low.x(), half.y() + door.low.y()});
  // Turning u towards the normal opens into the room; u x v = normal, so that is against v.
  const Mat33 R = Eigen::AngleAxisd(-opened_rad, wall.axis_v).toRotationMatrix();
  const Vec3 along = R * wall.axis_u, front = R * wall.normal;
  const Vec3 middle = hinge + half.x() * along - kHalfThickness_m * front;
  Body leaf = make_box("door", middle, {half.x(), kHalfThickness_m, half.y()}, std::atan2(along.y(), along.x()), 0.5);
  Plane& face = *std::max_element(leaf.faces.begin(), leaf.faces.end(), [&](const Plane& a, const Plane& b) {
    return a.normal.dot(front) < b.normal.dot(front);
  });
  for (Decal sheet : sheets) {
    sheet.centre = face.coordinates(hinge + R * (wall.point(sheet.centre) - hinge));
    face.decals.push_back(sheet);
  }
  return leaf;
}

}  // namespace

void move_sheets(double share, double shift_m, Random& random, Scene& scene) {
  for (Plane& wall : scene.walls) {
    for (Decal& decal : wall.decals) {
      if (random.uniform() >= share) continue;
      const double towards = random.uniform(0, 2 * kPi);
      decal.centre += shift_m * Vec2(std::cos(towards), std::sin(towards));
    }
  }
}

void darken_half(Random& random, Scene& scene) {
  const double towards = random.uniform(0, 2 * kPi);
  scene.darkness =
      Darkness{scene.low + scene.size / 2, Vec3(std::cos(towards), std::sin(towards), 0), random.uniform(0, 0.03)};
}

void hang_mirror(Random& random, Scene& scene) {
  Plane& wall = draw_wall(random, scene);
  WallPatch mirror{.mirror = true};
  const Vec2 size(random.uniform(0.5, 1.2), random.uniform(0.6, 1.6));
  mirror.low = {random.uniform(0.2, std::max(0.2, wall.size.x() - size.x() - 0.2)),
                random.uniform(0.2, std::max(0.2, wall.size.y() - size.y() - 0.2))};
  mirror.high = mirror.low + size;
  clear(wall, mirror);
  wall.patches.push_back(mirror);
}

void open_door(Random& random, Scene& scene) {
  Plane& wall = draw_wall(random, scene);
  WallPatch door;
  const double width_m = random.uniform(0.75, 0.9), height_m = std::min(2.05, wall.size.y() - 0.2);
  door.depth_m = random.uniform(1, 3);
  door.low = {random.uniform(0.15, std::max(0.15, wall.size.x() - width_m - 0.15)), 0.01};
  door.high = door.low + Vec2(width_m, height_m);
  const std::vector<Decal> sheets = clear(wall, door);
  wall.patches.push_back(door);
  scene.bodies.push_back(leaf_of(wall, door, deg_to_rad(random.uniform(20, 100)), sheets));
}

void stand_operator(Random& random, Scene& scene) {
  const Vec3 foot =
      scene.low + Vec3(random.uniform(0.2, 0.8) * scene.size.x(), random.uniform(0.2, 0.8) * scene.size.y(), 0);
  const double yaw_rad = random.uniform(0, 2 * kPi), tall_m = random.uniform(1.6, 1.9);
  const auto part = [&](double from, double to, double half_width_m, double half_depth_m) {
    const Vec3 middle = foot + Vec3(0, 0, tall_m * (from + to) / 2);
    scene.bodies.push_back(make_box("operator", middle, {half_width_m, half_depth_m, tall_m * (to - from) / 2}, yaw_rad,
                                    random.uniform(0.1, 0.6)));
  };
  part(0.02, 0.48, 0.16, 0.10);
  part(0.48, 0.84, 0.24, 0.13);
  part(0.84, 1.00, 0.09, 0.11);
}

}  // namespace roomcal::tools
