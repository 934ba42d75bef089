#include "tools/plan/layout.h"

#include <cmath>

#include <gtest/gtest.h>

namespace roomcal::tools {
namespace {

SheetOutline a4() {
  SheetOutline outline;
  outline.below_left_m = {-0.105, -0.192};
  outline.above_right_m = {0.105, 0.105};
  return outline;
}

std::vector<Wall> room_with_door() {
  std::vector<Wall> walls = box_walls("2x3x2.5", false);
  walls[1].keep_out_m.emplace_back(Vec2(0.5, 0), Vec2(1.4, 2.0));
  return walls;
}

Eigen::AlignedBox2d paper(const PlannedSheet& sheet) {
  return {sheet.at_m + a4().below_left_m, sheet.at_m + a4().above_right_m};
}

TEST(Layout, FullRoom_KeepsMarginsGapsAndTheDoorFree) {
  const std::vector<Wall> walls = room_with_door();
  LayoutMaker maker(walls, a4(), 1);
  while (maker.add()) {
  }
  const auto& sheets = maker.sheets();
  EXPECT_GT(sheets.size(), 100U);
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const Wall& wall = walls[sheets[i].wall];
    EXPECT_GE(paper(sheets[i]).min().minCoeff(), 0.05 - 1e-9);
    EXPECT_LE((paper(sheets[i]).max() - wall.size_m).maxCoeff(), -0.05 + 1e-9);
    for (const auto& keep_out : wall.keep_out_m) EXPECT_GE(paper(sheets[i]).exteriorDistance(keep_out), 0.049);
    for (std::size_t k = 0; k < i; ++k) {
      if (sheets[k].wall != sheets[i].wall) continue;
      const Vec2 apart = (paper(sheets[i]).center() - paper(sheets[k]).center()).cwiseAbs() - paper(sheets[i]).sizes();
      EXPECT_GE(apart.maxCoeff(), 0.02 - 1e-9) << i << ' ' << k;
    }
  }
}

TEST(Layout, SameSeed_GivesTheSameAndPrefixesAgree) {
  const std::vector<Wall> walls = room_with_door();
  LayoutMaker a(walls, a4(), 7), b(walls, a4(), 7), c(walls, a4(), 8);
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(a.add() && c.add());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(b.add());
  int different = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(a.sheets()[i].at_m, b.sheets()[i].at_m);
    EXPECT_EQ(a.sheets()[i].wall, b.sheets()[i].wall);
    different += a.sheets()[i].at_m != c.sheets()[i].at_m ? 1 : 0;
  }
  EXPECT_GT(different, 15);
}

TEST(Layout, FirstSheets_AreSpreadOverTheWallsByArea) {
  const std::vector<Wall> walls = box_walls("2x3x2.5", false);
  LayoutMaker maker(walls, a4(), 3);
  for (int i = 0; i < 62; ++i) ASSERT_TRUE(maker.add());  // 31 m^2
  std::vector<int> on(walls.size());
  for (const PlannedSheet& sheet : maker.sheets()) ++on[sheet.wall];
  for (std::size_t w = 0; w < walls.size(); ++w) EXPECT_NEAR(on[w], 2 * walls[w].size_m.prod(), 6) << walls[w].name;
}

TEST(Layout, Move_LeavesALayoutThatFits) {
  const std::vector<Wall> walls = box_walls("2x3x2.5", false);
  LayoutMaker maker(walls, a4(), 3);
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(maker.add());
  const Vec2 before = maker.sheets()[4].at_m;
  ASSERT_TRUE(maker.move(4, 0.12));
  EXPECT_GT((maker.sheets()[4].at_m - before).norm(), 0.03);
  EXPECT_LT((maker.sheets()[4].at_m - before).norm(), 0.14);
}

TEST(Layout, WallSmallerThanASheet_StaysEmpty) {
  std::vector<Wall> walls(1);
  walls[0].size_m = {0.3, 0.3};
  LayoutMaker maker(walls, a4(), 1);
  EXPECT_FALSE(maker.add());
}

TEST(MapOf, SheetsBecomeMarkersOnTheirWalls) {
  const std::vector<Wall> walls = box_walls("3x4x2.7", false);
  const MapData data = map_of(walls, {{1, {0.5, 1}}, {2, {1, 2}}, {0, {1, 1}}}, 2, 0.085, 0.002);
  ASSERT_EQ(data.markers.size(), 2U);
  EXPECT_LT((data.markers[0].p_room - Vec3(2.5, 0, 1)).norm(), 1e-12);
  EXPECT_LT((data.markers[0].normal_room - Vec3(0, 1, 0)).norm(), 1e-12);
  EXPECT_LT((data.markers[1].p_room - Vec3(3, 3, 2)).norm(), 1e-12);
  EXPECT_EQ(data.markers[1].radius_m, 0.085);
  EXPECT_NEAR(data.markers[1].cov_m2(2, 2), 4e-6, 1e-18);
}

}  // namespace
}  // namespace roomcal::tools
