#include "tools/bake/room_axes.h"

#include <gtest/gtest.h>

#include "tests/tools/map/box_room.h"
#include "tools/map/plane_fit.h"

namespace roomcal::tools {
namespace {

/// The 4 x 3 x 2.5 m box of markers, seen from a frame that hangs anyhow.
std::vector<map::MapMarker> markers_in(const SE3& T_survey_room) {
  std::vector<map::MapMarker> markers = test::box_room(40, 0.0005, 1).markers;
  for (map::MapMarker& marker : markers) marker.p_room = T_survey_room * marker.p_room;
  return markers;
}

const SE3 kT_survey_room{so3_exp({0.9, -0.4, 1.7}), Vec3(0.3, -1, 2)};

TEST(RoomAxes, TiltedSurvey_ComesToStandOnItsFloor) {
  std::vector<map::MapMarker> markers = markers_in(kT_survey_room);
  const auto planes = fit_planes(markers);
  const Vec3 up = (kT_survey_room.R * Vec3(0.3, -0.2, 1)).normalized();  // hands tilt cameras
  const RoomAxes axes = find_axes(markers, planes, kT_survey_room * Vec3(1, 1, 1.4), up);
  ASSERT_TRUE(axes.has_floor);
  Vec3 low = Vec3::Constant(9), high = Vec3::Constant(-9);
  for (const map::MapMarker& marker : markers) {
    low = low.cwiseMin(axes.T_room_survey * marker.p_room);
    high = high.cwiseMax(axes.T_room_survey * marker.p_room);
  }
  EXPECT_LT(low.cwiseAbs().maxCoeff(), 0.01);
  EXPECT_NEAR(high.x(), 3, 0.01);  // the shorter side
  EXPECT_NEAR(high.y(), 4, 0.01);
}

// With x along the shorter side and the room at positive coordinates, two opposite corners can be the origin.
TEST(RoomAxes, Origin_IsTheCornerNearTheStart) {
  std::vector<map::MapMarker> markers = markers_in(kT_survey_room);
  const auto planes = fit_planes(markers);
  for (const Vec3& start : {Vec3(3.5, 0.5, 1), Vec3(0.5, 2.5, 1)}) {
    const RoomAxes axes = find_axes(markers, planes, kT_survey_room * start, kT_survey_room.R * Vec3::UnitZ());
    EXPECT_LT((axes.T_room_survey * (kT_survey_room * start)).head<2>().norm(), 1);
  }
}

TEST(RoomAxes, NoFloor_LeavesTheSurveysAxesAndSaysSo) {
  std::vector<map::MapMarker> markers = markers_in(kT_survey_room);
  std::erase_if(markers, [](const map::MapMarker& m) { return m.id < 40; });  // the floor's
  const auto planes = fit_planes(markers);
  const RoomAxes axes = find_axes(markers, planes, Vec3::Zero(), kT_survey_room.R * Vec3::UnitZ());
  EXPECT_FALSE(axes.has_floor);
  EXPECT_EQ(axes.T_room_survey.t, Vec3::Zero());
  EXPECT_NE(axes.description.find("no floor found"), std::string::npos);
}

}  // namespace
}  // namespace roomcal::tools
