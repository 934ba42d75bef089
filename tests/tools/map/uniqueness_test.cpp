#include "tools/map/uniqueness.h"

#include <gtest/gtest.h>

#include "tests/tools/map/box_room.h"

namespace roomcal::tools {
namespace {

std::vector<map::MapMarker> grid(double jitter_m, uint64_t seed) {
  Random random(seed);
  std::vector<map::MapMarker> markers;
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 8; ++y) {
      map::MapMarker marker;
      marker.id = static_cast<uint32_t>(markers.size());
      marker.p_room = Vec3(0.3 * x + jitter_m * random.normal(), 0.3 * y + jitter_m * random.normal(), 0);
      marker.normal_room = Vec3::UnitZ();
      marker.has_normal = true;
      markers.push_back(marker);
    }
  }
  return markers;
}

TEST(MeasureUniqueness, RegularGrid_IsZero) {
  const auto result = measure_uniqueness(grid(0, 1));
  ASSERT_TRUE(result);
  EXPECT_LT(result->worst_m, 1e-9);
  EXPECT_LT(result->median_m, 1e-9);
}

// Two noisy grids of sigma differ by about sqrt(2) sigma per axis before fitting; the best of many turns is less.
TEST(MeasureUniqueness, JitteredGrid_GrowsWithTheJitter) {
  const auto small = measure_uniqueness(grid(0.005, 2)), large = measure_uniqueness(grid(0.02, 2));
  ASSERT_TRUE(small && large);
  EXPECT_GT(small->worst_m, 0.001);
  EXPECT_LT(small->median_m, 0.012);
  EXPECT_GT(large->median_m, 2.5 * small->median_m);
}

TEST(MeasureUniqueness, CopiedCorner_IsFoundAsTheWorst) {
  std::vector<map::MapMarker> markers = test::box_room(22, 0, 3).markers;
  const auto before = measure_uniqueness(markers);
  // The floor's surroundings of marker 0 once more, two rooms away and turned by 90 degrees.
  std::vector<map::MapMarker> copy;
  for (const map::MapMarker& marker : markers) {
    if ((marker.p_room - markers[0].p_room).norm() > 2.2) continue;
    copy.push_back(marker);
    copy.back().id += 1000;
    copy.back().p_room = Vec3(20 - marker.p_room.y(), marker.p_room.x(), marker.p_room.z());
  }
  for (map::MapMarker& marker : markers) marker.has_normal = true, marker.normal_room = Vec3::UnitZ();
  for (map::MapMarker& marker : copy) marker.has_normal = true, marker.normal_room = Vec3::UnitZ();
  markers.insert(markers.end(), copy.begin(), copy.end());
  const auto after = measure_uniqueness(markers);
  ASSERT_TRUE(before && after);
  EXPECT_GT(before->worst_m, 0.01);
  EXPECT_LT(after->worst_m, 1e-6);
  EXPECT_EQ(std::max(after->worst_id, after->worst_other_id), std::min(after->worst_id, after->worst_other_id) + 1000);
}

TEST(MeasureUniqueness, TooFewMarkers_HaveNone) {
  EXPECT_FALSE(measure_uniqueness({}));
  EXPECT_FALSE(measure_uniqueness(std::vector<map::MapMarker>(17)));
}

}  // namespace
}  // namespace roomcal::tools
