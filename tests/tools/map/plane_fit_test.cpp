#include "tools/map/plane_fit.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/tools/map/box_room.h"

namespace roomcal::tools {
namespace {

TEST(FitPlanes, NoisyBox_GivesItsFivePlanesPointingInward) {
  constexpr std::size_t kPerPlane = 60;
  for (const uint64_t seed : {1U, 2U, 3U}) {
    MapData data = test::box_room(kPerPlane, 0.003, seed);
    const std::vector<PlaneData> planes = fit_planes(data.markers);
    ASSERT_EQ(planes.size(), 5U) << seed;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < data.markers.size(); ++i) {
      const int plane = data.markers[i].plane;
      if (plane < 0 ||
          planes[static_cast<std::size_t>(plane)].plane.normal_room.dot(test::box_normal(i, kPerPlane)) < 0.999) {
        ++wrong;  // a marker within the tolerance of two planes may go to either
      }
    }
    EXPECT_LE(wrong, data.markers.size() / 50) << seed;
    for (const PlaneData& plane : planes) EXPECT_NEAR(plane.plane.rms_m, 0.003, 0.0015);
  }
}

TEST(FitPlanes, SameMarkers_GiveTheSamePlanes) {
  MapData first = test::box_room(40, 0.005, 4), second = first;
  const auto a = fit_planes(first.markers), b = fit_planes(second.markers);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].plane.normal_room, b[i].plane.normal_room);
}

TEST(FitPlanes, Outline_IsConvexCounterClockwiseAndHoldsEveryMarker) {
  MapData data = test::box_room(40, 0.002, 5);
  const auto planes = fit_planes(data.markers);
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const std::vector<Vec3>& outline = planes[k].outline_room;
    ASSERT_GE(outline.size(), 3U);
    for (std::size_t v = 0; v < outline.size(); ++v) {
      const Vec3 a = outline[v], b = outline[(v + 1) % outline.size()];
      for (const map::MapMarker& marker : data.markers) {
        if (marker.plane != static_cast<int>(k)) continue;
        EXPECT_GE((b - a).cross(marker.p_room - a).dot(planes[k].plane.normal_room), -1e-9);
      }
    }
  }
}

TEST(FitPlanes, MarkersOnALine_AreNoPlane) {
  std::vector<map::MapMarker> markers(20);
  for (std::size_t i = 0; i < markers.size(); ++i) markers[i].p_room = Vec3(0.2 * static_cast<double>(i), 1, 2);
  EXPECT_TRUE(fit_planes(markers).empty());
}

TEST(FitPlanes, MarkersAllInOnePlaceOrNone_AreNoPlane) {
  std::vector<map::MapMarker> markers(20);
  EXPECT_TRUE(fit_planes(markers).empty());
  markers.clear();
  EXPECT_TRUE(fit_planes(markers).empty());
}

TEST(FitPlanes, ScatteredMarkers_AreNoPlane) {
  Random random(8);
  std::vector<map::MapMarker> markers(30);
  for (map::MapMarker& marker : markers) {
    marker.p_room = Vec3(random.uniform(0, 4), random.uniform(0, 4), random.uniform(0, 4));
  }
  EXPECT_TRUE(fit_planes(markers).empty());
}

// A pillar's face looks away from most of the room; only the survey can say so.
TEST(FitPlanes, SurveyedNormals_DecideTheSide) {
  MapData data = test::box_room(40, 0, 6);
  for (std::size_t i = 0; i < data.markers.size(); ++i) {
    data.markers[i].normal_room = -test::box_normal(i, 40);
    data.markers[i].has_normal = true;
  }
  const auto planes = fit_planes(data.markers);
  ASSERT_EQ(planes.size(), 5U);
  for (std::size_t i = 0; i < data.markers.size(); ++i) {
    const int plane = data.markers[i].plane;
    ASSERT_GE(plane, 0);
    EXPECT_GT(planes[static_cast<std::size_t>(plane)].plane.normal_room.dot(data.markers[i].normal_room), 0.999);
  }
}

}  // namespace
}  // namespace roomcal::tools
