#include "tools/bake/bake.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/tools/bake/synthetic_survey.h"
#include "tests/tools/refusal.h"
#include "tools/bake/bake_report.h"
#include "tools/map/compare.h"
#include "tools/map/map_builder.h"

namespace roomcal::tools {
namespace {

using test::contains;
using test::make_survey;
using test::refusal;
using test::SyntheticSurvey;

MapData truth_of(const SyntheticSurvey& s) {
  MapData data;
  for (std::size_t i = 0; i < s.room.size(); ++i) {
    map::MapMarker marker;
    marker.id = static_cast<uint32_t>(i);
    marker.p_room = s.room[i].p_room;
    data.markers.push_back(marker);
  }
  return data;
}

std::vector<std::byte> bytes_of(BakeResult result) {
  result.data.id = "room";
  result.data.provenance = "test";
  const AlignedBytes bytes = build_map(result.data);
  return {bytes.span().begin(), bytes.span().end()};
}

TEST(Bake, WalkWithNoise_GivesTheRoomWithoutPhantoms) {
  const SyntheticSurvey s = make_survey(1, 0.1);
  const BakeResult result = bake(s.survey, s.rig, {});
  EXPECT_EQ(result.map.order.size(), s.survey.views.size());
  const auto comparison = compare_maps(truth_of(s), result.data);
  ASSERT_TRUE(comparison);
  EXPECT_EQ(comparison->matched.size(), result.data.markers.size());
  EXPECT_GT(comparison->matched.size(), 120U);
  EXPECT_LT(comparison->rms_m, 0.002);
}

TEST(Bake, RoomAxes_FloorAtZeroAndRoomAtPositiveCoordinates) {
  const SyntheticSurvey s = make_survey(2, 0.05);
  const BakeResult result = bake(s.survey, s.rig, {});
  ASSERT_TRUE(result.axes.has_floor);
  for (const map::MapMarker& marker : result.data.markers) EXPECT_GT(marker.p_room.minCoeff(), -0.01);
  EXPECT_GE(result.data.corners.size(), 2U);
}

TEST(Bake, PairsOutOfOrderAndEmptyOnes_AreSurvivedAndNamed) {
  SyntheticSurvey s = make_survey(3, 0.05);
  truth::Random random(9);
  for (std::size_t i = s.survey.views.size(); i > 1; --i) {
    std::swap(s.survey.views[i - 1], s.survey.views[random.index(i)]);
  }
  for (const Side side : kBothSides) s.survey.views[5].seen[side].clear();
  const BakeResult result = bake(s.survey, s.rig, {});
  EXPECT_EQ(result.map.order.size(), s.survey.views.size() - 1);
  EXPECT_EQ(result.summary.views_without_markers, std::vector<std::size_t>{5});
  const auto path = bake_json(s.survey, s.rig, result)["path"];  // in the survey's order, the placed ones only
  ASSERT_EQ(path.size(), s.survey.views.size() - 1);
  EXPECT_EQ(path[4]["name"], s.survey.views[4].name);
  EXPECT_EQ(path[5]["name"], s.survey.views[6].name);
  EXPECT_EQ(path[5]["at"][2].get<double>(), result.map.views[6].T_room_left.t.z());
}

/// Blur moves rings by pixels and hides some.
void blur(StereoView& view, truth::Random& random) {
  for (const Side side : kBothSides) {
    view.seen[side].resize(view.seen[side].size() / 2);
    for (Sighting& sighting : view.seen[side]) sighting.centre_px += 25 * random.normals<2>();
  }
}

TEST(Bake, BlurredAndForeignPairs_AreSurvivedAndNamed) {
  SyntheticSurvey s = make_survey(12, 0.05);
  truth::Random random(12);
  blur(s.survey.views[20], random);
  blur(s.survey.views[31], random);
  s.survey.views[40] = make_survey(13, 0.05, 2).survey.views[1];
  const BakeResult result = bake(s.survey, s.rig, {});
  const auto& lost = result.summary.views_lost;
  const auto& without = result.summary.views_without_markers;
  for (const std::size_t view : {20U, 31U, 40U}) {
    EXPECT_EQ(std::count(lost.begin(), lost.end(), view) + std::count(without.begin(), without.end(), view), 1) << view;
  }
  EXPECT_EQ(result.map.order.size(), s.survey.views.size() - 3);
  const auto comparison = compare_maps(truth_of(s), result.data);
  ASSERT_TRUE(comparison);
  EXPECT_EQ(comparison->matched.size(), result.data.markers.size());
  EXPECT_LT(comparison->rms_m, 0.002);
}

TEST(Bake, PairsLostOnTheWay_LeaveAGapThatIsBridged) {
  SyntheticSurvey s = make_survey(14, 0.05);
  s.survey.views.erase(s.survey.views.begin() + 20, s.survey.views.begin() + 23);
  const BakeResult result = bake(s.survey, s.rig, {});
  EXPECT_EQ(result.map.order.size(), s.survey.views.size());
}

TEST(Bake, ScatteredSightings_AreNoMarkers) {
  SyntheticSurvey s = make_survey(4, 0.05);
  truth::Random random(10);
  for (StereoView& view : s.survey.views) {
    for (const Side side : kBothSides) {
      for (int i = 0; i < 2; ++i) {
        view.seen[side].push_back({{random.uniform(0, 1279), random.uniform(0, 1023)}, Mat22::Identity(), {}});
      }
    }
  }
  const BakeResult result = bake(s.survey, s.rig, {});
  const auto comparison = compare_maps(truth_of(s), result.data);
  ASSERT_TRUE(comparison);
  EXPECT_EQ(comparison->matched.size(), result.data.markers.size());
}

TEST(Bake, SameSurveyTwice_GivesTheSameBytes) {
  const SyntheticSurvey s = make_survey(5, 0.1);
  EXPECT_EQ(bytes_of(bake(s.survey, s.rig, {})), bytes_of(bake(s.survey, s.rig, {})));
}

TEST(Bake, WrongFocalLength_IsMendedByRefinement) {
  const SyntheticSurvey s = make_survey(6, 0.03);
  StereoRig wrong = s.rig;
  for (const Side side : kBothSides) {
    camera::Intrinsics k = s.rig.cameras[side].intrinsics();
    k.fx_px *= 1.002;
    k.fy_px *= 1.002;
    wrong.cameras[side] = camera::Camera::create(k).value();
  }
  BakeOptions options;
  const BakeResult result = bake(s.survey, wrong, options);
  EXPECT_NEAR(result.map.rig.cameras[kLeft].intrinsics().fx_px / s.rig.cameras[kLeft].intrinsics().fx_px, 1, 3e-4);
}

TEST(Bake, SwappedSides_SaysSo) {
  SyntheticSurvey s = make_survey(7, 0.05, 8);
  for (StereoView& view : s.survey.views) std::swap(view.seen[kLeft], view.seen[kRight]);
  EXPECT_TRUE(contains(refusal([&] { bake(s.survey, s.rig, {}); }), "left and right are swapped"));
}

TEST(Bake, AnotherPairsCalibration_SaysSo) {
  SyntheticSurvey s = make_survey(8, 0.05, 8);
  StereoRig wrong = s.rig;
  wrong.T_right_left = {so3_exp({0.1, 0, 0.05}), Vec3(-0.3, 0.1, 0)};
  EXPECT_TRUE(contains(refusal([&] { bake(s.survey, wrong, {}); }), "the stereo calibration does not belong"));
}

TEST(Bake, NoMarkersAtAll_SaysSo) {
  SyntheticSurvey s = make_survey(9, 0.05, 8);
  for (StereoView& view : s.survey.views) view.seen = {};
  EXPECT_TRUE(contains(refusal([&] { bake(s.survey, s.rig, {}); }), "no markers in any left image"));
}

TEST(Bake, TwoRooms_SaysSo) {
  SyntheticSurvey s = make_survey(10, 0.05);
  const SyntheticSurvey other = make_survey(11, 0.05);
  s.survey.views.insert(s.survey.views.end(), other.survey.views.begin(), other.survey.views.end());
  EXPECT_TRUE(contains(refusal([&] { bake(s.survey, s.rig, {}); }), "two rooms"));
}

}  // namespace
}  // namespace roomcal::tools
