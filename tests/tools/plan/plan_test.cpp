#include "tools/plan/plan.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"
#include "tools/map/map_import.h"
#include "tools/plan/plan_report.h"

namespace roomcal::tools {
namespace {

/// Few looks: these tests are about the plan, not about the room.
PlanOptions quick(std::size_t sheets) {
  PlanOptions options;
  options.outline.below_left_m = {-0.105, -0.192};
  options.outline.above_right_m = {0.105, 0.105};
  options.sheets = sheets;
  options.coverage.max_positions = 4;
  return options;
}

TEST(Plan, MoreSheets_LocateMoreLooksAndBetter) {
  const std::vector<Wall> walls = box_walls("3x3x2.5", false);
  const Plan few = make_plan(walls, quick(40)), many = make_plan(walls, quick(120));
  EXPECT_EQ(few.sheets.size(), 40U);
  EXPECT_GT(many.coverage.located_share, few.coverage.located_share);
  EXPECT_LT(many.coverage.median_sigma_m, few.coverage.median_sigma_m);
  EXPECT_GT(few.coverage.median_sigma_m, 0);
}

TEST(Plan, NoCount_FindsTheFewestOfItsSeriesThatMeetTheTarget) {
  const std::vector<Wall> walls = box_walls("2x2x2", false);
  PlanOptions options = quick(0);
  options.target_share = 0.5;
  const Plan plan = make_plan(walls, options);
  EXPECT_TRUE(plan.met);
  EXPECT_GE(plan.coverage.located_share, 0.5);
  const Plan fewer = make_plan(walls, quick(plan.sheets.size() * 8 / 9));
  EXPECT_LE(fewer.coverage.located_share, plan.coverage.located_share);
}

TEST(Plan, TargetOutOfReach_IsFullAndNotMet) {
  PlanOptions options = quick(0);
  options.target_share = 1.01;
  options.outline.gap_m = 0.15;  // soon full
  const Plan plan = make_plan(box_walls("2x2x2", false), options);
  EXPECT_TRUE(plan.full);
  EXPECT_FALSE(plan.met);
}

TEST(Plan, LooseMap_ShowsInThePredictedSigma) {
  const std::vector<Wall> walls = box_walls("2x2x2", false);
  PlanOptions loose = quick(60);
  loose.map_sigma_m = 0.004;
  EXPECT_GT(make_plan(walls, loose).coverage.median_sigma_m, 2 * make_plan(walls, quick(60)).coverage.median_sigma_m);
}

TEST(Plan, Places_AreUnique) {
  const Plan plan = make_plan(box_walls("2x3x2", false), quick(100));
  ASSERT_TRUE(plan.uniqueness);
  EXPECT_GE(plan.uniqueness->worst_m, 0.02);
}

TEST(Plan, WallsTooSmall_AreRefusedWithTheNumberThatFits) {
  std::vector<Wall> wall(1);
  wall[0].name = "board";
  wall[0].size_m = {0.3, 0.3};
  const auto refused = [&](std::size_t sheets) {
    return test::refusal([&] { static_cast<void>(make_plan(wall, quick(sheets))); });
  };
  EXPECT_TRUE(test::contains(refused(0), "no sheet fits")) << refused(0);
  wall[0].size_m = {1, 1};
  EXPECT_TRUE(test::contains(refused(0), "a room needs 18")) << refused(0);
  EXPECT_TRUE(test::contains(refused(200), "--sheets 200: only")) << refused(200);
}

TEST(PlanReport, CsvIsWhatMapImportReads) {
  const Plan plan = make_plan(box_walls("2x2x2", false), quick(30));
  const MapData read = parse_map_csv("plan.csv", layout_csv(plan));
  ASSERT_EQ(read.markers.size(), 30U);
  for (std::size_t i = 0; i < read.markers.size(); ++i) {
    EXPECT_LT((read.markers[i].p_room - plan.data.markers[i].p_room).norm(), 1e-4);
    EXPECT_LT((read.markers[i].normal_room - plan.data.markers[i].normal_room).norm(), 1e-8);
    EXPECT_NEAR(read.markers[i].radius_m, 0.085, 1e-9);
  }
}

TEST(PlanReport, JsonHoldsEverySheetOnceAndEveryPlace) {
  const Plan plan = make_plan(box_walls("2x2x2", false), quick(30));
  const auto json = plan_json(plan);
  std::vector<bool> seen(30);
  for (const auto& wall : json["walls"]) {
    for (const auto& sheet : wall["sheets"]) seen[sheet["id"].get<std::size_t>()] = true;
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), 30);
  int looks = 0, located = 0;
  for (const auto& place : json["coverage"]["places"]) {
    looks += place["looks"].get<int>();
    located += place["located"].get<int>();
  }
  EXPECT_EQ(looks, json["coverage"]["looks"].get<int>());
  EXPECT_NEAR(json["coverage"]["located_share"].get<double>(), static_cast<double>(located) / looks, 1e-12);
}

}  // namespace
}  // namespace roomcal::tools
