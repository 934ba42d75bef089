#include "tools/map/noise.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/tools/map/box_room.h"
#include "tools/map/complete_map.h"

namespace roomcal::tools {
namespace {

TEST(AddNoise, SameSeed_GivesTheSameMap) {
  const MapData exact = test::box_room(60, 0, 1);
  MapData a = exact, b = exact, c = exact;
  add_noise(a, 0.01, 7, true);
  add_noise(b, 0.01, 7, true);
  add_noise(c, 0.01, 8, true);
  EXPECT_EQ(a.markers[5].p_room, b.markers[5].p_room);
  EXPECT_NE(a.markers[5].p_room, c.markers[5].p_room);
}

TEST(AddNoise, Planes_FollowTheirMarkersAndSayHowWell) {
  MapData data = test::box_room(60, 0, 1);
  complete_map(data);
  ASSERT_EQ(data.planes.size(), 5U);
  EXPECT_TRUE(data.planes[0].plane.cov.isZero(0));
  const Vec3 normal = data.planes[0].plane.normal_room;
  add_noise(data, 0.005, 7, true);
  EXPECT_NE(data.planes[0].plane.normal_room, normal);
  EXPECT_GT(data.planes[0].plane.normal_room.dot(normal), 0.999);
  EXPECT_NEAR(data.planes[0].plane.rms_m, 0.005, 0.002);
  EXPECT_FALSE(data.planes[0].plane.cov.isZero(0));
}

TEST(AddNoise, Spread_IsSigmaPerAxis) {
  const MapData exact = test::box_room(200, 0, 1);
  MapData noisy = exact;
  add_noise(noisy, 0.01, 7, true);
  double squares_m2 = 0;
  for (std::size_t i = 0; i < exact.markers.size(); ++i) {
    squares_m2 += (noisy.markers[i].p_room - exact.markers[i].p_room).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squares_m2 / 3 / static_cast<double>(exact.markers.size())), 0.01, 0.0005);
}

TEST(AddNoise, Declared_AddsToTheCovarianceThatWasThere) {
  MapData data = test::box_room(10, 0, 1);
  data.markers[0].cov_m2 = 1e-6 * Mat33::Identity();
  MapData hidden = data;
  add_noise(data, 0.002, 7, true);
  add_noise(hidden, 0.002, 7, false);
  EXPECT_TRUE(data.markers[0].cov_m2.isApprox(5e-6 * Mat33::Identity()));
  EXPECT_TRUE(hidden.markers[0].cov_m2.isApprox(1e-6 * Mat33::Identity()));
  EXPECT_EQ(data.markers[0].p_room, hidden.markers[0].p_room);
}

}  // namespace
}  // namespace roomcal::tools
