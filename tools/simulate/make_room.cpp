#include "tools/simulate/make_room.h"

#include <cmath>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "tools/common/error.h"
#include "tools/common/random.h"
#include "tools/simulate/planar.h"

namespace roomcal::tools {

namespace {

constexpr double kLean_rad = deg_to_rad(0.25);  // sigma of a wall's lean
constexpr double kGap_m = 0.004;                // between sheets
constexpr double kBorder_m = 0.015;             // from a sheet to the end of its wall
constexpr int kTriesPerSheet = 20000;
constexpr double kWallAlbedo = 0.42, kFloorAlbedo = 0.28, kCeilingAlbedo = 0.6, kPillarAlbedo = 0.45;

void build_walls(const RoomOptions& options, Random& random, Scene& scene) {
  const Vec3& size = options.size;
  const auto leaning = [&](const Vec3& normal) {
    return Vec3(normal + kLean_rad * Vec3(random.normal(), random.normal(), random.normal()));
  };
  const Vec3 far = size;
  scene.walls = {make_plane("floor", Vec3::Zero(), Vec3::UnitZ(), kFloorAlbedo),
                 make_plane("wall_x0", Vec3::Zero(), leaning(Vec3::UnitX()), kWallAlbedo),
                 make_plane("wall_y0", Vec3::Zero(), leaning(Vec3::UnitY()), kWallAlbedo),
                 make_plane("wall_x1", Vec3(far.x(), far.y(), 0), leaning(-Vec3::UnitX()), kWallAlbedo),
                 make_plane("wall_y1", Vec3(far.x(), far.y(), 0), leaning(-Vec3::UnitY()), kWallAlbedo),
                 make_plane("ceiling", far, -Vec3::UnitZ(), kCeilingAlbedo)};
  scene.walls.front().tile_m = 0.6;
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

void build_bodies(const RoomOptions& options, Random& random, Scene& scene) {
  const Vec3& size = options.size;
  if (options.pillar) {
    const Vec3 half(random.uniform(0.15, 0.2), random.uniform(0.15, 0.2), size.z());
    const Vec3 centre(size.x() - half.x() + 0.02, size.y() * random.uniform(0.35, 0.65), size.z() / 2);
    scene.bodies.push_back(make_box("pillar", centre, half, deg_to_rad(random.uniform(-2, 2)), kPillarAlbedo));
  }
  for (int i = 0; i < options.boxes; ++i) {
    const Vec3 half(random.uniform(0.03, 0.12), random.uniform(0.03, 0.12), random.uniform(0.2, 0.6));
    const Vec3 centre(size.x() * random.uniform(0.15, 0.85), size.y() * random.uniform(0.15, 0.85), half.z());
    scene.bodies.push_back(
        make_box(fmt::format("box{}", i), centre, half, random.uniform(0, kPi), random.uniform(0.1, 0.7)));
  }
}

void build_lamps(const RoomOptions& options, Random& random, Scene& scene) {
  const Vec3& size = options.size;
  for (const double depth : {0.28, 0.74}) {
    Lamp panel;
    panel.half_size = Vec2(0.15, 0.45);
    panel.centre =
        Vec3(size.x() * random.uniform(0.3, 0.7), size.y() * (depth + random.uniform(-0.05, 0.05)), size.z() - 0.005);
    panel.intensity = random.uniform(0.8, 1.6);
    scene.lamps.push_back(panel);
  }
  Lamp bulb;  // near a wall: steep light on the sheets beside it, hard shadows behind things
  bulb.all_around = true;
  bulb.centre = Vec3(size.x() * random.uniform(0.1, 0.25), size.y() * random.uniform(0.2, 0.8),
                     size.z() * random.uniform(0.6, 0.8));
  bulb.intensity = random.uniform(0.08, 0.16);
  scene.lamps.push_back(bulb);
  scene.ambient = 0.06;
}

/// Puts pieces of paper where there is room for them.
class Paster {
 public:
  Paster(Scene& scene, Random& random) : scene_(scene), random_(random) {}

  /// @return false if there is no place left.
  bool paste(Decal decal) {
    for (int attempt = 0; attempt < kTriesPerSheet; ++attempt) {
      Plane& wall = random_wall();
      decal.angle_rad = random_.uniform(-kPi, kPi);
      decal.centre = Vec2(random_.uniform(0, wall.size.x()), random_.uniform(0, wall.size.y()));
      if (!fits(wall, decal)) continue;
      wall.decals.push_back(decal);
      return true;
    }
    return false;
  }

 private:
  /// Floor and walls by their area.
  Plane& random_wall() {
    const std::size_t count = scene_.walls.size() - 1;
    double total = 0;
    for (std::size_t i = 0; i < count; ++i) total += scene_.walls[i].size.prod();
    double pick = random_.uniform(0, total);
    for (std::size_t i = 0; i < count; ++i) {
      pick -= scene_.walls[i].size.prod();
      if (pick < 0) return scene_.walls[i];
    }
    return scene_.walls.front();
  }

  bool fits(const Plane& wall, const Decal& decal) const {
    const double c = std::abs(std::cos(decal.angle_rad)), s = std::abs(std::sin(decal.angle_rad));
    const Vec2 reach(c * decal.half_size.x() + s * decal.half_size.y(),
                     s * decal.half_size.x() + c * decal.half_size.y());
    const Vec2 border = Vec2::Constant(kBorder_m);
    if ((decal.centre - reach - border).minCoeff() < 0) return false;
    if ((wall.size - decal.centre - reach - border).minCoeff() < 0) return false;
    for (const Body& body : scene_.bodies) {
      if (clearance(body, wall.point(decal.centre)) < decal.half_size.norm()) return false;
    }
    for (const Decal& other : wall.decals) {
      if (overlap(decal, other, kGap_m)) return false;
    }
    return true;
  }

  Scene& scene_;
  Random& random_;
};

void paste_markers(const RoomOptions& options, Paster& paster) {
  Decal sheet;
  sheet.print = Print::kRings;
  sheet.half_size = Vec2(kSheetWidth_m, kSheetHeight_m) / 2;
  sheet.radius_m = kMarkerRadius_m;
  for (int id = 0; id < options.markers; ++id) {
    sheet.marker_id = id;
    if (paster.paste(sheet)) continue;
    throw ToolError(
        fmt::format("--markers {}: only {} sheets fit into a room of {} x {} x {} m; take fewer or a larger --size",
                    options.markers, id, options.size.x(), options.size.y(), options.size.z()));
  }
}

void paste_distractors(const RoomOptions& options, Random& random, Paster& paster) {
  for (int i = 0; i < options.distractors; ++i) {
    Decal decal;
    decal.print = static_cast<Print>(1 + i % 5);
    decal.radius_m = random.uniform(0.03, 0.07);
    decal.half_size = Vec2(1.25, 1.25) * decal.radius_m;
    if (!paster.paste(decal)) return;  // a full wall needs no more of them
  }
}

}  // namespace

Scene make_room(const RoomOptions& options) {
  if (!(options.size.minCoeff() >= 1 && options.size.maxCoeff() <= 50)) {
    throw ToolError("--size: width, depth and height must be 1 to 50 m, as in 3x4x2.7");
  }
  Scene scene;
  scene.seed = options.seed;
  scene.size = options.size;
  Random random(options.seed);
  build_walls(options, random, scene);
  build_bodies(options, random, scene);
  build_lamps(options, random, scene);
  Paster paster(scene, random);
  paste_markers(options, paster);
  paste_distractors(options, random, paster);
  return scene;
}

}  // namespace roomcal::tools
