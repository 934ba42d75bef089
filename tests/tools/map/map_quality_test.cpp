#include "tools/map/map_quality.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/tools/map/box_room.h"
#include "tools/map/complete_map.h"

namespace roomcal::tools {
namespace {

/// Small and fast: the sanitizers run this too.
CoverageOptions few_positions() {
  CoverageOptions options;
  options.max_positions = 6;
  return options;
}

MapData whole_room(std::size_t per_plane, uint64_t seed) {
  MapData data = test::box_room(per_plane, 0, seed);
  complete_map(data);
  return data;
}

bool any_holds(const std::vector<std::string>& lines, const std::string& words) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const auto& line) { return line.find(words) != std::string::npos; });
}

TEST(Coverage, FullRoom_IsLocatedNearlyEverywhere) {
  const Coverage coverage = measure_coverage(whole_room(45, 1), few_positions());
  ASSERT_FALSE(coverage.views.empty());
  EXPECT_GT(coverage.located_share, 0.8);
  EXPECT_GT(coverage.median_sigma_m, 1e-5);
  EXPECT_LT(coverage.median_sigma_m, 2e-3);
  EXPECT_GE(coverage.least_gap, CoverageOptions{}.enough_gap);
}

TEST(Coverage, SparseRoom_IsMissedAndAdvised) {
  const MapQuality quality = measure_map_quality(whole_room(12, 2), few_positions());
  EXPECT_LT(quality.coverage.seen_share, 0.8);
  EXPECT_TRUE(any_holds(quality.advice, "add markers on plane"));
  EXPECT_FALSE(any_holds(quality.advice, "-0.0"));
}

TEST(Coverage, SameMap_GivesTheSameFigures) {
  const MapData data = whole_room(30, 3);
  const Coverage a = measure_coverage(data, few_positions()), b = measure_coverage(data, few_positions());
  EXPECT_EQ(a.median_sigma_m, b.median_sigma_m);
  EXPECT_EQ(a.least_gap, b.least_gap);
}

TEST(MapQuality, MarkerOffItsWall_IsNamed) {
  MapData data = whole_room(30, 4);
  const auto worst = std::find_if(data.markers.begin(), data.markers.end(), [](const auto& m) { return m.plane == 0; });
  worst->p_room += 0.1 * data.planes[0].plane.normal_room;
  const MapQuality quality = measure_map_quality(data, few_positions());
  EXPECT_EQ(quality.planes[0].worst_id, worst->id);
  EXPECT_NEAR(quality.planes[0].max_m, 0.1, 1e-6);
  EXPECT_TRUE(any_holds(quality.advice, "is not flat"));
}

TEST(MapQuality, RegularGrid_IsAdvisedToBeBroken) {
  MapData data;
  for (uint32_t i = 0; i < 48; ++i) {
    map::MapMarker marker;
    marker.id = i;
    marker.p_room = Vec3(0.3 * (i % 8), 0.3 * (i / 8), 0);
    data.markers.push_back(marker);
  }
  complete_map(data);
  EXPECT_TRUE(any_holds(measure_map_quality(data, few_positions()).advice, "look alike"));
}

TEST(MapQuality, Json_HasWhatTheHeaderSays) {
  const auto json = map_quality_json(measure_map_quality(whole_room(20, 5), few_positions()));
  EXPECT_EQ(json["planes"].size(), 5U);
  for (const char* key : {"views", "seen_share", "located_share", "median_sigma_mm", "least_gap", "median_gap"})
    EXPECT_TRUE(json["coverage"].contains(key)) << key;
  EXPECT_GT(json["uniqueness"]["worst_mm"].get<double>(), 0);
}

}  // namespace
}  // namespace roomcal::tools
