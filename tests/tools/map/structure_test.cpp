#include "tools/map/structure.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/tools/map/box_room.h"
#include "tools/map/plane_fit.h"

namespace roomcal::tools {
namespace {

MapData structured(MapData data) {
  data.planes = fit_planes(data.markers);
  find_structure(data);
  return data;
}

bool has_vertex_near(const std::vector<Vec3>& outline, const Vec3& p_room, double distance_m) {
  return std::any_of(outline.begin(), outline.end(),
                     [&](const Vec3& vertex) { return (vertex - p_room).norm() < distance_m; });
}

TEST(Structure, BoxRoom_HasItsEdgesAndFloorCorners) {
  const MapData data = structured(test::box_room(40, 0.0005, 1));
  ASSERT_EQ(data.planes.size(), 5U);
  EXPECT_EQ(data.lines.size(), 8U);  // four along the floor, four upright
  ASSERT_EQ(data.corners.size(), 4U);
  for (const double x : {0.0, 4.0}) {
    for (const double y : {0.0, 3.0}) {
      EXPECT_TRUE(
          std::any_of(data.corners.begin(), data.corners.end(),
                      [&](const map::MapCorner& corner) { return (corner.p_room - Vec3(x, y, 0)).norm() < 0.005; }))
          << x << " " << y;
    }
  }
}

TEST(Structure, FloorsOutline_ReachesTheCorners) {
  const MapData data = structured(test::box_room(40, 0.0005, 2));
  for (const PlaneData& plane : data.planes) {
    if (plane.plane.normal_room.z() < 0.9) continue;
    EXPECT_EQ(plane.outline_room.size(), 4U);
    for (const double x : {0.0, 4.0}) {
      for (const double y : {0.0, 3.0}) EXPECT_TRUE(has_vertex_near(plane.outline_room, {x, y, 0}, 0.005));
    }
  }
}

TEST(Structure, Walls_ReachFromTheFloorToTheirHighestMarker) {
  const MapData data = structured(test::box_room(40, 0.0, 3));
  for (std::size_t p = 0; p < data.planes.size(); ++p) {
    if (data.planes[p].plane.normal_room.z() > 0.9) continue;
    double highest = 0, top = 0, bottom = 9;
    for (const map::MapMarker& marker : data.markers)
      if (marker.plane == static_cast<int>(p)) highest = std::max(highest, marker.p_room.z());
    for (const Vec3& vertex : data.planes[p].outline_room) {
      top = std::max(top, vertex.z());
      bottom = std::min(bottom, vertex.z());
    }
    EXPECT_NEAR(bottom, 0, 1e-6);
    EXPECT_NEAR(top, highest, 1e-6);
  }
}

TEST(Structure, LinesEndInTheirCorners) {
  const MapData data = structured(test::box_room(40, 0.0, 4));
  for (const map::MapLine& line : data.lines) {
    for (const map::MapCorner& corner : data.corners) {
      const auto& planes = corner.planes;
      if (std::find(planes.begin(), planes.end(), line.plane_a) == planes.end()) continue;
      if (std::find(planes.begin(), planes.end(), line.plane_b) == planes.end()) continue;
      EXPECT_LT(std::min((corner.p_room - line.from_room).norm(), (corner.p_room - line.to_room).norm()), 1e-9);
    }
  }
}

TEST(Structure, PillarOnTheFloor_DoesNotCutTheFloor) {
  MapData data = test::box_room(40, 0.0, 5);
  Random random(5);
  // A face of a pillar in the middle of the room, 0.6 m wide.
  for (int i = 0; i < 12; ++i) {
    map::MapMarker marker;
    marker.id = static_cast<uint32_t>(data.markers.size());
    marker.p_room = Vec3(2, random.uniform(1.2, 1.8), random.uniform(0.2, 2));
    data.markers.push_back(marker);
  }
  data = structured(data);
  ASSERT_EQ(data.planes.size(), 6U);
  for (const PlaneData& plane : data.planes) {
    if (plane.plane.normal_room.z() < 0.9) continue;
    for (const double x : {0.0, 4.0}) EXPECT_TRUE(has_vertex_near(plane.outline_room, {x, 0, 0}, 0.005));
  }
  const auto foot = std::find_if(data.lines.begin(), data.lines.end(), [](const map::MapLine& line) {
    return std::abs(line.from_room.x() - 2) < 0.01 && std::abs(line.to_room.x() - 2) < 0.01;
  });
  ASSERT_NE(foot, data.lines.end());
  EXPECT_LT((foot->from_room - foot->to_room).norm(), 0.7);
}

TEST(Structure, WallsThatDoNotMeet_HaveNoEdge) {
  MapData data = test::box_room(40, 0.0, 6);
  // The far wall begins four metres behind the others' end.
  for (map::MapMarker& marker : data.markers)
    if (marker.p_room.x() == 4) marker.p_room.x() = 8;
  data = structured(data);
  EXPECT_EQ(data.corners.size(), 2U);
}

}  // namespace
}  // namespace roomcal::tools
