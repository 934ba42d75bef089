#include "runtime/scan/planes.h"

#include <cmath>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/runtime/scan/rays.h"
#include "tests/truth/random.h"
#include "tools/evaluate/lidar_trial.h"

namespace roomcal::scan {
namespace {

struct Seen {
  std::vector<RayBlock> rays;
  SE3 T_room_lidar;
  std::size_t count() const { return ray_count(rays); }
};

Seen see(const tools::LidarRoom& room, tools::Tilt tilt, uint64_t seed) {
  Seen seen;
  tools::Random random(seed);
  seen.T_room_lidar = tools::random_lidar_pose(room.scene(), tilt, random);
  const tools::SimulatedSweep sweep = room.simulator().sweep(tools::vlp16_beams(), {}, seen.T_room_lidar, seed);
  const lidar::Sweep view = sweep.view();
  for_each_block({{&view, 1}}, {}, 14, [&](const RayBlock& block) { seen.rays.push_back(block); });
  return seen;
}

TEST(ExtractPlanes, TiltedSweeps_LargePlanesAreWallsOfTheRoom) {
  const tools::LidarRoom room(5);
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const Seen seen = see(room, tools::Tilt::kTilted, seed);
    const SweepPlanes planes = extract_planes(seen.rays, 0.015);
    ASSERT_GE(planes.size(), 4U);
    for (const SweepPlane& plane : planes) {
      if (plane.points < seen.count() / 12) continue;
      double best = 1e9;
      for (const Face& face : room.surface().faces()) {
        const double cos = face.normal_room.dot(seen.T_room_lidar.R * plane.normal_lidar);
        const double height_m = face.normal_room.dot(seen.T_room_lidar.t) + face.d_m;
        best = std::min(best, std::acos(std::min(1.0, cos)) + std::abs(height_m - plane.d_m));
      }
      EXPECT_LT(best, 0.025) << "seed " << seed;  // rad plus metres
    }
  }
}

TEST(ExtractPlanes, NoiseInABall_FindsNoPlane) {
  truth::Random random(6);
  std::vector<test::Ray> rays(1500);
  for (test::Ray& ray : rays) {
    ray.direction_lidar = random.normals<3>().normalized();
    ray.range_m = random.uniform(0.5, 5);
  }
  for (const SweepPlane& plane : extract_planes(test::blocks_of(rays), 0.015))
    EXPECT_LT(plane.points, rays.size() / 12);
}

TEST(ExtractPlanes, FewRays_FindsNone) {
  EXPECT_TRUE(extract_planes({}, 0.015).empty());
  const std::vector<test::Ray> few(10);
  EXPECT_TRUE(extract_planes(test::blocks_of(few), 0.015).empty());
}

TEST(FindCorners, TiltedSweeps_CornersAreTheRoomsAndDirectionsOrthogonal) {
  const tools::LidarRoom room(5);
  int close = 0, corners_seen = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const Seen seen = see(room, tools::Tilt::kTilted, seed);
    const SweepPlanes planes = extract_planes(seen.rays, 0.015);
    for (const Corner& corner : find_corners(planes)) {
      const Mat33& D = corner.directions_lidar;
      EXPECT_LT((D.transpose() * D - Mat33::Identity()).norm(), 1e-9);
      for (int i = 0; i < 3; ++i)
        EXPECT_GT(D.col(i).dot(planes[corner.plane[static_cast<std::size_t>(i)]].normal_lidar), 0.9);
      if (planes[corner.plane[2]].points < seen.count() / 12) continue;
      ++corners_seen;
      double nearest_m = 1e9;
      for (const Face& face : room.surface().faces()) {
        for (const Vec3& vertex : room.surface().vertices_room(face)) {
          nearest_m = std::min(nearest_m, (vertex - seen.T_room_lidar * corner.p_lidar).norm());
        }
      }
      close += nearest_m < 0.05 ? 1 : 0;
    }
  }
  EXPECT_GE(corners_seen, 5);
  // A pillar's face and a wall meet nowhere, but their planes do.
  EXPECT_GT(close, corners_seen * 8 / 10);
}

}  // namespace
}  // namespace roomcal::scan
