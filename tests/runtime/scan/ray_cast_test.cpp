#include "runtime/scan/ray_cast.h"

#include <gtest/gtest.h>

#include "tests/runtime/scan/box.h"
#include "tests/truth/random.h"
#include "tools/evaluate/lidar_trial.h"
#include "tools/simulate/ray.h"

namespace roomcal::scan {
namespace {

TEST(RayCast, RaysInARoomWithPillar_MeetWhatTheSimulatorMeets) {
  const tools::LidarRoom room(3);
  truth::Random random(1);
  for (int pose = 0; pose < 20; ++pose) {
    const SE3 T_room_lidar = tools::random_lidar_pose(room.scene(), tools::Tilt::kTilted, random);
    PosedSurface posed;
    posed.set(room.surface(), T_room_lidar);
    for (int i = 0; i < 500; ++i) {
      const Vec3 direction = random.normals<3>().normalized();
      const RayHit hit = posed.first_hit(direction);
      const tools::Hit truth = tools::cast_ray(room.scene(), T_room_lidar.t, T_room_lidar.R * direction);
      ASSERT_NE(hit.face, kNoFace);
      EXPECT_NEAR(hit.range_m, truth.distance, 1e-3);  // a ray on an edge may take either side
    }
  }
}

TEST(RayCast, FaceFromBehind_IsSaidToBeSo) {
  const test::Box box(Vec3(3, 4, 2.7));
  PosedSurface posed;
  posed.set(box.surface(), {Mat33::Identity(), Vec3(-1, 2, 1)});  // outside, looking in
  const RayHit hit = posed.first_hit(Vec3::UnitX());
  EXPECT_EQ(hit.face, kNoFace);
  EXPECT_TRUE(hit.from_behind);
}

TEST(RayCast, RayThatLeaves_MeetsNothing) {
  const test::Box box(Vec3(3, 4, 2.7));
  PosedSurface posed;
  posed.set(box.surface(), {Mat33::Identity(), Vec3(-1, 2, 1)});
  EXPECT_EQ(posed.first_hit(-Vec3::UnitX()).face, kNoFace);
  EXPECT_FALSE(posed.first_hit(-Vec3::UnitX()).from_behind);
}

TEST(RayCast, SecondHit_IsTheNextPlaneContinued) {
  const test::Box box(Vec3(3, 4, 2.7));
  PosedSurface posed;
  posed.set(box.surface(), {Mat33::Identity(), Vec3(1, 2, 1)});
  const Vec3 direction = Vec3(2, 0, -1.1).normalized();  // meets the floor just before wall x1
  const RayHits hits = posed.first_two_hits(direction);
  EXPECT_NEAR((hits.first.range_m * direction).z(), -1, 1e-9);
  EXPECT_NEAR((hits.second.range_m * direction).x(), 2, 1e-9);
}

}  // namespace
}  // namespace roomcal::scan
