#include "tools/map/complete_map.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/tools/map/box_room.h"

namespace roomcal::tools {
namespace {

TEST(CompleteMap, MarkersWithoutNormal_GetTheirPlanesAndSaySo) {
  MapData data = test::box_room(30, 0.001, 1);
  std::reverse(data.markers.begin(), data.markers.end());
  map::MapMarker astray;
  astray.id = 1000;
  astray.p_room = Vec3(2, 1.5, 1.2);
  data.markers.push_back(astray);
  complete_map(data);
  ASSERT_TRUE(std::is_sorted(data.markers.begin(), data.markers.end(),
                             [](const auto& a, const auto& b) { return a.id < b.id; }));
  for (const map::MapMarker& marker : data.markers) {
    EXPECT_EQ(marker.has_normal, marker.id != 1000) << marker.id;
    EXPECT_EQ(marker.normal_estimated, marker.has_normal);
  }
}

TEST(CompleteMap, SurveyedNormals_Stay) {
  MapData data = test::box_room(30, 0, 2);
  const Vec3 tilted = Vec3(0.1, 0, 1).normalized();
  data.markers[0].normal_room = tilted;
  data.markers[0].has_normal = true;
  complete_map(data);
  EXPECT_EQ(data.markers[0].normal_room, tilted);
  EXPECT_FALSE(data.markers[0].normal_estimated);
}

TEST(CompleteMap, Triangles_AreBakedOfThreeDifferentMarkers) {
  MapData data = test::box_room(30, 0, 3);
  complete_map(data);
  EXPECT_GT(data.triangles.size(), data.markers.size());
  for (const auto& [a, b, c] : data.triangles) {
    EXPECT_LT(std::max({a, b, c}), data.markers.size());
    EXPECT_TRUE(a != b && b != c && a != c);
  }
}

}  // namespace
}  // namespace roomcal::tools
