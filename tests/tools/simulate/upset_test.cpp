#include "tools/simulate/upset.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/marker/detector.h"
#include "tools/common/image_io.h"
#include "tools/simulate/echo.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/planar.h"
#include "tools/simulate/ray.h"
#include "tools/simulate/shot.h"

namespace roomcal::tools {
namespace {

Scene box_room(uint64_t seed) {
  RoomOptions options;
  options.seed = seed;
  options.distractors = 0;
  return make_room(options);
}

std::map<int, SceneMarker> by_id(const Scene& scene) {
  std::map<int, SceneMarker> markers;
  for (const SceneMarker& marker : markers_of(scene)) markers[marker.id] = marker;
  return markers;
}

const Plane* patched_wall(const Scene& scene) {
  for (const Plane& wall : scene.walls)
    if (!wall.patches.empty()) return &wall;
  return nullptr;
}

bool within(const Scene& scene, const Vec3& point_room) {
  constexpr double kReach_m = 1e-6;
  return std::all_of(scene.walls.begin(), scene.walls.end(),
                     [&](const Plane& wall) { return wall.signed_distance(point_room) > -kReach_m; });
}

TEST(Upset, MovedSheets_AreSoManyAndSoFarOff) {
  const Scene before = box_room(3);
  Scene after = before;
  Random random(1);
  move_sheets(0.3, 0.02, random, after);
  const auto old = by_id(before);
  int moved = 0;
  for (const auto& [id, marker] : by_id(after)) {
    const double off_m = (marker.centre_room - old.at(id).centre_room).norm();
    EXPECT_TRUE(off_m == 0 || std::abs(off_m - 0.02) < 1e-12) << off_m;
    moved += off_m > 0 ? 1 : 0;
  }
  EXPECT_NEAR(moved, 0.3 * 340, 30);
}

TEST(Upset, DarkHalf_HasNextToNoLightAndTheOtherKeepsIts) {
  const Scene before = box_room(3);
  Scene after = before;
  Random random(2);
  darken_half(random, after);
  const Vec3 middle = after.size / 2, into_dark = after.darkness->into_dark, up = Vec3::UnitZ();
  for (const double side : {-1.0, 1.0}) {
    const Vec3 place(middle.x() + side * into_dark.x(), middle.y() + side * into_dark.y(), 0);
    const double share = irradiance(after, place, up) / irradiance(before, place, up);
    if (side > 0) {
      EXPECT_LE(share, 0.03);
    } else {
      EXPECT_EQ(share, 1);
    }
  }
}

TEST(Upset, Mirror_SendsLidarsToWhatItShowsAndHidesItsSheets) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene before = box_room(3);
    Scene after = before;
    Random random(seed);
    hang_mirror(random, after);
    const Plane* wall = patched_wall(after);
    ASSERT_NE(wall, nullptr);
    const WallPatch& mirror = wall->patches[0];
    for (const Decal& decal : wall->decals) EXPECT_FALSE(mirror.covers(decal.centre));
    const EchoCaster caster(after);
    RangeFlaws none;
    none.sigma_m = 0;
    const Vec3 eye = after.size / 2;
    const Vec3 at = wall->point((mirror.low + mirror.high) / 2), direction = (at - eye).normalized();
    const double range_m = caster.echo({eye, direction}, none, random).range_m;
    // By hand: on to the mirror, then back by the law of reflection onto a wall or the floor.
    const double to_mirror_m = (at - eye).norm();
    const Vec3 back = direction - 2 * direction.dot(wall->normal) * wall->normal;
    const Vec3 end = at + (range_m - to_mirror_m) * back;
    double off_m = 1e9;
    for (const Plane& other : after.walls) off_m = std::min(off_m, std::abs(other.signed_distance(end)));
    EXPECT_GT(range_m, to_mirror_m + 0.5);
    EXPECT_LT(off_m, 1e-9);
  }
}

/// A camera before a wall's patch, a metre off, looking at it askew.
TrueCamera camera_before(const Plane& wall, const WallPatch& patch) {
  const Vec3 at = wall.point((patch.low + patch.high) / 2), eye = at + 1.0 * wall.normal + 0.2 * wall.axis_u;
  SE3 T_room_cam;
  T_room_cam.R.col(2) = (at - eye).normalized();
  T_room_cam.R.col(1) = -(wall.axis_v - T_room_cam.R.col(2) * T_room_cam.R.col(2).dot(wall.axis_v)).normalized();
  T_room_cam.R.col(0) = T_room_cam.R.col(1).cross(T_room_cam.R.col(2));
  T_room_cam.t = eye;
  const camera::Intrinsics lens{camera::Model::kPinholeRadtan, 960, 720, 900, 900, 479.5, 359.5, {}};
  return {"cam0", camera::Camera::create(lens).value(), T_room_cam};
}

TEST(Upset, Mirror_ShowsRingsInPicturesWhereTruthHasTheirImages) {
  Scene scene = box_room(3);
  scene.lamps.clear();
  scene.ambient = 1;
  Random random(4);
  hang_mirror(random, scene);
  const Plane& wall = *patched_wall(scene);
  const TrueCamera camera = camera_before(wall, wall.patches[0]);
  const LitScene lit(scene);
  const Picture picture = take_picture(lit, camera, {}, 1);
  std::vector<std::byte> memory(64U << 20);
  Arena scratch(memory);
  std::vector<marker::Detection> rings(256);
  std::size_t count = 0;
  ASSERT_TRUE(marker::detect(view(picture.image), {}, scratch, rings, count).ok());
  rings.resize(count);
  int seen = 0;
  for (const MarkerTruth& image : project_mirrored_markers(scene, camera.camera, camera.T_room_cam)) {
    if (image.visible < 1 || image.outer.minor_px < 25) continue;
    double nearest_px = 1e9;
    for (const marker::Detection& ring : rings)
      if (ring.status == marker::DetectionStatus::kOk)
        nearest_px = std::min(nearest_px, (ring.centre_px - image.uv_px).norm());
    EXPECT_LT(nearest_px, 0.15) << image.id;
    ++seen;
  }
  EXPECT_GE(seen, 4);
}

TEST(Upset, OpenDoor_TakesItsSheetsAlongAndShowsWhatIsBehind) {
  const Scene before = box_room(5);
  const auto old = by_id(before);
  int turned = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    Scene after = before;
    Random random(seed);
    open_door(random, after);
    const Plane& wall = *patched_wall(after);
    const WallPatch& door = wall.patches[0];
    const Vec3 hinge = wall.point({door.low.x(), 0});
    const auto from_hinge_m = [&](const Vec3& p) {
      return ((p - hinge) - (p - hinge).dot(wall.axis_v) * wall.axis_v).norm();
    };
    for (const auto& [id, marker] : by_id(after)) {
      if (marker.centre_room == old.at(id).centre_room) continue;
      EXPECT_NEAR(from_hinge_m(marker.centre_room), from_hinge_m(old.at(id).centre_room), 0.01);
      EXPECT_GT(wall.signed_distance(marker.centre_room), 0.005);
      ++turned;
    }
    const Vec3 at = wall.point((door.low + door.high) / 2), eye = at + 0.01 * wall.normal;
    const Sight sight = look(after, eye, {-wall.normal, Mat32::Zero()});
    EXPECT_NEAR(sight.hit.distance, 0.01 + door.depth_m, 1e-9);
  }
  EXPECT_GE(turned, 10);
}

TEST(Upset, Operator_StandsInTheRoom) {
  const Scene before = box_room(5);
  Scene after = before;
  Random random(1);
  stand_operator(random, after);
  ASSERT_EQ(after.bodies.size(), before.bodies.size() + 3);
  double top_m = 0;
  for (const Body& part : after.bodies) {
    EXPECT_TRUE(within(after, part.centre));
    for (const Vec3& corner : corners_of(part)) top_m = std::max(top_m, corner.z());
  }
  EXPECT_GT(top_m, 1.59);
  EXPECT_LT(top_m, 1.91);
}

}  // namespace
}  // namespace roomcal::tools
