#include "tools/simulate/room_walls.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tools/common/error.h"
#include "tools/simulate/echo.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/marker_truth.h"
#include "tools/simulate/planar.h"
#include "tools/simulate/ray.h"
#include "tools/simulate/stand.h"

namespace roomcal::tools {
namespace {

/// An L: 5 x 4 m without the quarter x > 3, y > 2; a ramp leads up one of its walls. The ceiling is open over the short
/// arm.
constexpr const char* kLayout = R"(
walls:
  - {name: floor, corner: [0, 0, 0], right: [1, 0, 0], up: [0, 1, 0], size: [3, 4]}
  - {name: floor arm, corner: [3, 0, 0], right: [1, 0, 0], up: [0, 1, 0], size: [2, 2]}
  - {name: south, corner: [5, 0, 0], right: [-1, 0, 0], size: [5, 2.6], keep_out: [[1, 0, 2, 2]]}
  - {name: west, corner: [0, 0, 0], right: [0, 1, 0], size: [4, 2.6]}
  - {name: north, corner: [0, 4, 0], right: [1, 0, 0], size: [3, 2.6]}
  - {name: inner east, corner: [3, 4, 0], right: [0, -1, 0], size: [2, 2.6]}
  - {name: inner north, corner: [3, 2, 0], right: [1, 0, 0], size: [2, 2.6]}
  - {name: east, corner: [5, 2, 0], right: [0, -1, 0], size: [2, 2.6]}
  - {name: ceiling, corner: [3, 0, 2.6], right: [-1, 0, 0], up: [0, 1, 0], size: [3, 4]}
)";

RoomOptions layout_options() {
  RoomOptions options;
  options.seed = 4;
  options.markers = 200;
  options.walls = read_walls("layout.yaml", kLayout);
  return options;
}

const Scene& layout() {
  static const Scene scene = make_room(layout_options());
  return scene;
}

const Plane& wall_named(const Scene& scene, const std::string& name) {
  for (const Plane& wall : scene.walls)
    if (wall.name == name) return wall;
  throw ToolError("no wall " + name);
}

bool in_l(const Vec3& p) { return p.x() > 0 && p.y() > 0 && p.x() < 5 && p.y() < 4 && (p.x() < 3 || p.y() < 2); }

TEST(DrawnWalls, Sheets_AreOnAllWallsWithinTheirEndsAndOffWhatIsKeptFree) {
  std::size_t sheets = 0;
  for (const Plane& wall : layout().walls) {
    EXPECT_GT(wall.decals.size(), 3U) << wall.name;
    for (const Decal& decal : wall.decals) {
      EXPECT_TRUE(wall.covers(decal.centre));
      sheets += decal.print == Print::kRings ? 1U : 0U;
    }
  }
  EXPECT_EQ(sheets, 200U);
  for (const Decal& decal : wall_named(layout(), "south").decals)
    EXPECT_FALSE(decal.centre.x() > 1 && decal.centre.x() < 2 && decal.centre.y() < 2);
}

TEST(DrawnWalls, Rays_MeetTheNearestWallOrLeaveThroughTheOpening) {
  const auto wall_along = [&](const Vec3& from, const Vec3& along) {
    const Hit hit = cast_ray(layout(), from, along);
    return hit.plane == nullptr ? std::string() : hit.plane->name;
  };
  EXPECT_EQ(wall_along({1, 1, 1}, {1, 0, 0}), "east");
  EXPECT_EQ(wall_along({1, 3, 1}, {1, 0, 0}), "inner east");
  EXPECT_EQ(wall_along({4, 1, 1}, {0, 1, 0}), "inner north");
  EXPECT_EQ(wall_along({1, 1, 1}, {0, 0, 1}), "ceiling");
  EXPECT_EQ(wall_along({4, 1, 1}, {0, 0, 1}), "");
  EXPECT_EQ(wall_along({3.6, 1, 1}, Vec3(-1, 1, 0).normalized()), "north");  // past the inner corner
}

TEST(DrawnWalls, WallAroundTheCorner_HidesAndThrowsShadow) {
  EXPECT_TRUE(is_hidden(layout(), {4.5, 1.5, 1}, {2.5, 3.5, 1}));
  EXPECT_FALSE(is_hidden(layout(), {4.5, 1.5, 1}, {1, 1, 1}));
  const Plane& north = wall_named(layout(), "north");
  const Vec3 on_wall = north.point({1, 1});
  EXPECT_FALSE(is_hidden(layout(), {1, 1, 1}, on_wall));
  EXPECT_FALSE(is_hidden(layout(), on_wall + 1e-6 * north.normal, {1, 1, 1}));
}

TEST(DrawnWalls, FreeSpace_IsTheInsideOfTheL) {
  Random random(3);
  for (int i = 0; i < 400; ++i) {
    const Vec3 p(random.uniform(-1, 6), random.uniform(-1, 5), random.uniform(0.3, 2.3));
    if (std::abs(p.x()) < 0.01 || std::abs(p.y()) < 0.01) continue;
    EXPECT_EQ(in_free_space(layout(), p), in_l(p)) << p.transpose();
  }
  for (int i = 0; i < 50; ++i) {
    const Vec3 place = draw_free_place(layout(), 1.2, 0.5, random);
    EXPECT_TRUE(in_l(place));
    EXPECT_NEAR(place.z(), 1.2, 1e-12);
    for (const Plane& wall : layout().walls) {
      const bool beside = wall.covers(wall.coordinates(place));
      EXPECT_GT(beside ? wall.signed_distance(place) : 1.0, 0.5);
    }
  }
}

TEST(DrawnWalls, EveryDevice_StandsWithinAndSeesMarkers) {
  for (const PaperDevice& device : known_devices()) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      ShotOptions options;
      options.seed = seed;
      const Stand stand = place_device(layout(), device, options);
      for (const auto& [name, T_room_sensor] : sensor_poses(stand)) EXPECT_TRUE(in_l(T_room_sensor.t)) << name;
      std::size_t seen = 0;
      for (const TrueCamera& camera : stand.cameras) {
        for (const MarkerTruth& marker : project_markers(layout(), camera.camera, camera.T_room_cam))
          seen += marker.visible > 0.99 ? 1U : 0U;
      }
      EXPECT_GT(seen, 10U) << device.name;
    }
  }
}

TEST(DrawnWalls, OpenCeiling_GivesNoEcho) {
  const EchoCaster caster(layout());
  Random random(1);
  Pulse up;
  up.origin_room = Vec3(4, 1, 1);
  up.direction_room = Vec3::UnitZ();
  EXPECT_EQ(caster.echo(up, {}, random).range_m, 0);
  up.origin_room.x() = 1;
  EXPECT_NEAR(caster.echo(up, {.sigma_m = 0}, random).range_m, 1.6, 1e-12);
}

TEST(DrawnWalls, TooFewOrTurnedOutside_IsRefused) {
  RoomOptions options = layout_options();
  options.walls.resize(2);
  EXPECT_THROW(make_room(options), ToolError);
  options = layout_options();
  for (Wall& wall : options.walls) wall.right_room = -wall.right_room;
  EXPECT_THROW(make_room(options), ToolError);
  options = layout_options();
  options.pillar = true;
  EXPECT_THROW(make_room(options), ToolError);
}

Scene wavy_room() {
  RoomOptions options;
  options.seed = 6;
  options.waviness_m = 0.003;
  return make_room(options);
}

TEST(Waves, SurfaceSpreadsAsAskedAndEndsFlat) {
  const Scene scene = wavy_room();
  double squares = 0;
  for (const Plane& wall : scene.walls) {
    const Waviness waviness = waviness_of(wall);
    squares += waviness.sigma_m * waviness.sigma_m / static_cast<double>(scene.walls.size());
    EXPECT_LT(waviness.max_m, 0.012);
    EXPECT_EQ(wall.height({0, wall.size.y() / 2}), 0);
  }
  EXPECT_GT(std::sqrt(squares), 0.0015);  // the fading at the ends takes some of it
  EXPECT_LT(std::sqrt(squares), 0.0035);
}

TEST(Waves, Slope_IsTheHeightsDerivative) {
  const Scene scene = wavy_room();
  const Plane& wall = scene.walls[1];
  Random random(5);
  constexpr double kStep_m = 1e-5;
  for (int i = 0; i < 200; ++i) {
    const Vec2 q(random.uniform(0.001, wall.size.x()), random.uniform(0.001, wall.size.y()));
    const Vec2 across(kStep_m, 0), up(0, kStep_m);
    const Vec2 numeric =
        Vec2(wall.height(q + across) - wall.height(q - across), wall.height(q + up) - wall.height(q - up)) /
        (2 * kStep_m);
    EXPECT_LT((wall.slope(q) - numeric).norm(), 1e-5);
    EXPECT_LT(wall.slope(q).norm(), 0.2);
  }
}

TEST(Waves, Rays_EndOnTheSurface) {
  const Scene scene = wavy_room();
  Random random(2);
  double off_plane_m = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 along = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    const Vec3 from(1.4, 2.2, 1.1);
    const Hit hit = cast_ray(scene, from, along);
    ASSERT_NE(hit.plane, nullptr);
    const Vec3 p_room = from + hit.distance * along;
    ASSERT_NEAR(hit.plane->signed_distance(p_room), hit.plane->height(hit.plane->coordinates(p_room)), 1e-7);
    off_plane_m = std::max(off_plane_m, std::abs(hit.plane->signed_distance(p_room)));
  }
  EXPECT_GT(off_plane_m, 0.003);
}

TEST(Waves, Markers_LieOnTheSurfaceAndLeanWithIt) {
  const Scene scene = wavy_room();
  double lean_rad = 0;
  for (const SceneMarker& marker : markers_of(scene)) {
    double nearest_m = 1;
    for (const Plane& wall : scene.walls) {
      const Vec2 q = wall.coordinates(marker.centre_room);
      if (!wall.covers(q)) continue;
      const double off_m = std::abs(wall.signed_distance(marker.centre_room) - wall.height(q));
      if (off_m > nearest_m) continue;
      nearest_m = off_m;
    }
    EXPECT_LT(nearest_m, 1e-9);
    double upright = 0;
    for (const Plane& wall : scene.walls) upright = std::max(upright, wall.normal.dot(marker.normal_room));
    lean_rad = std::max(lean_rad, std::acos(std::min(1.0, upright)));
  }
  EXPECT_GT(lean_rad, deg_to_rad(0.3));
  EXPECT_LT(lean_rad, deg_to_rad(5));
}

TEST(Waves, FlatRoom_IsAsItWasWithout) {
  RoomOptions options;
  options.seed = 6;
  const auto flat = markers_of(make_room(options)), wavy = markers_of(wavy_room());
  ASSERT_EQ(flat.size(), wavy.size());
  for (std::size_t i = 0; i < flat.size(); ++i) EXPECT_LT((flat[i].centre_room - wavy[i].centre_room).norm(), 0.012);
}

}  // namespace
}  // namespace roomcal::tools
