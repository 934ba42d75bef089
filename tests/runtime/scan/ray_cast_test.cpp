#include "runtime/scan/ray_cast.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/runtime/scan/box.h"
#include "tests/runtime/scan/rays.h"
#include "tests/truth/random.h"
#include "tools/evaluate/lidar_trial.h"
#include "tools/simulate/ray.h"

namespace roomcal::scan {
namespace {

using test::cast_one;
using test::Hit;
using test::hit_of;
using test::Ray;

TEST(RayCast, RaysInARoomWithPillar_MeetWhatTheSimulatorMeets) {
  const tools::LidarRoom room(3);
  truth::Random random(1);
  for (int pose = 0; pose < 20; ++pose) {
    const SE3 T_room_lidar = tools::random_lidar_pose(room.scene(), tools::Tilt::kTilted, random);
    const PosedSurface posed(room.surface(), T_room_lidar);
    for (int i = 0; i < 500; ++i) {
      const Vec3 direction = random.normals<3>().normalized();
      const Hit hit = cast_one(posed, direction);
      const tools::Hit truth = tools::cast_ray(room.scene(), T_room_lidar.t, T_room_lidar.R * direction);
      ASSERT_NE(hit.face, kNoFace);
      EXPECT_NEAR(hit.range_m, truth.distance, 1e-3);  // a ray on an edge may take either side
    }
  }
}

/// Rays of one block bound what is asked of the surface: how they are put together must not show.
TEST(RayCast, NarrowAndWideBlocks_SayOfEachRayWhatItSaysAlone) {
  const tools::LidarRoom room(4);
  truth::Random random(2);
  for (int round = 0; round < 300; ++round) {
    const SE3 T_room_lidar = tools::random_lidar_pose(room.scene(), tools::Tilt::kSteep, random);
    const PosedSurface posed(room.surface(), T_room_lidar);
    const Vec3 axis = random.normals<3>().normalized();
    const double spread = random.uniform(0.001, 1);
    std::vector<Ray> rays(1 + random.index(kBlockRays));
    for (Ray& ray : rays) ray.direction_lidar = (axis + spread * random.normals<3>()).normalized();
    BlockHits hits;
    posed.cast(test::blocks_of(rays)[0], hits);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const Hit hit = hit_of(posed, hits, i);
      if (i >= rays.size()) {
        EXPECT_EQ(hit.face, kNoFace);
        continue;
      }
      const Hit alone = cast_one(posed, rays[i].direction_lidar);
      EXPECT_EQ(hit.face, alone.face);
      EXPECT_EQ(hit.range_m, alone.range_m);
    }
  }
}

TEST(RayCast, FaceFromBehind_IsSaidToBeSo) {
  const test::Box box(Vec3(3, 4, 2.7));
  const PosedSurface posed(box.surface(), {Mat33::Identity(), Vec3(-1, 2, 1)});  // outside, looking in
  EXPECT_TRUE(cast_one(posed, Vec3::UnitX()).from_behind);
}

TEST(RayCast, RayThatLeaves_MeetsNothing) {
  const test::Box box(Vec3(3, 4, 2.7));
  const PosedSurface posed(box.surface(), {Mat33::Identity(), Vec3(-1, 2, 1)});
  EXPECT_EQ(cast_one(posed, -Vec3::UnitX()).face, kNoFace);
}

TEST(RayCast, SensorInThePlaneOfAWall_SeesTheOthers) {
  const test::Box box(Vec3(3, 4, 2.7));
  const PosedSurface posed(box.surface(), {Mat33::Identity(), Vec3(0, 2, 1)});
  truth::Random random(5);
  for (int i = 0; i < 1000; ++i) {
    Vec3 direction = random.normals<3>().normalized();
    direction.x() = std::abs(direction.x());
    const Hit hit = cast_one(posed, direction);
    ASSERT_NE(hit.face, kNoFace);
    const Vec3 p_room = Vec3(0, 2, 1) + hit.range_m * direction;
    EXPECT_TRUE((p_room.array() > -1e-3).all() && ((Vec3(3, 4, 2.7) - p_room).array() > -1e-3).all());
  }
}

TEST(RayCast, SecondHit_IsTheNextPlaneContinued) {
  const test::Box box(Vec3(3, 4, 2.7));
  const PosedSurface posed(box.surface(), {Mat33::Identity(), Vec3(1, 2, 1)});
  const Ray ray{Vec3(2, 0, -1.1).normalized(), 1, 0};  // meets the floor just before wall x1
  const std::vector<RayBlock> block = test::blocks_of({&ray, 1});
  BlockHits first, second;
  posed.cast(block[0], first);
  posed.cast_behind(block[0], first, second);
  EXPECT_NEAR((hit_of(posed, first, 0).range_m * ray.direction_lidar).z(), -1, 1e-6);
  EXPECT_NEAR((hit_of(posed, second, 0).range_m * ray.direction_lidar).x(), 2, 1e-6);
  EXPECT_EQ(second.face[1], kNoFace);
}

}  // namespace
}  // namespace roomcal::scan
