#include "tools/plan/wall.h"

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

constexpr const char* kDoor = R"(walls:
  - name: north
    corner: [0, 4, 0]
    right: [2, 0, 0]
    size: [3, 2.7]
    keep_out: [[0.5, 0, 1.4, 2.0]]
  - name: floor
    corner: [0, 0, 0]
    right: [1, 0, 0]
    up: [0, 1, 0]
    size: [3, 4]
)";

TEST(BoxWalls, AllFaceTheMiddleAndCloseTheBox) {
  const std::vector<Wall> walls = box_walls("3x4x2.7", true);
  ASSERT_EQ(walls.size(), 6U);
  const Vec3 middle(1.5, 2, 1.35), size(3, 4, 2.7);
  Vec3 sum = Vec3::Zero();
  double area_m2 = 0;
  for (const Wall& wall : walls) {
    EXPECT_GT(wall.normal_room().dot(middle - wall.corner_room), 1) << wall.name;
    sum += wall.normal_room();
    area_m2 += wall.size_m.prod();
    for (const Vec2& at : {Vec2(0, 0), Vec2(wall.size_m.x(), 0), wall.size_m}) {  // corners of the box, all of them
      const Vec3 p = wall.point_room(at);
      for (int k = 0; k < 3; ++k)
        EXPECT_TRUE(p[k] == 0 || std::abs(p[k] - size[k]) < 1e-12) << wall.name << p.transpose();
    }
    if (wall.name.starts_with("wall")) {
      EXPECT_EQ(wall.up_room, Vec3::UnitZ());
      EXPECT_EQ(wall.corner_room.z(), 0);
    }
  }
  EXPECT_LT(sum.norm(), 1e-12);
  EXPECT_NEAR(area_m2, 2 * (12 + 3 * 2.7 + 4 * 2.7), 1e-12);
  EXPECT_EQ(box_walls("3x4x2.7", false).size(), 5U);
}

TEST(BoxWalls, TooSmallOrNonsense_IsRefused) {
  for (const char* text : {"0.5x4x2.7", "3x4x0", "3x4", "3x4x2.7m", "", "nanx4x2", "-3x4x2", "3x400x2", "axbxc"}) {
    EXPECT_TRUE(test::contains(test::refusal([&] { static_cast<void>(box_walls(text, false)); }), "--room")) << text;
  }
}

TEST(ReadWalls, NamesSizesAndKeepOut_AreRead) {
  const std::vector<Wall> walls = read_walls("w.yaml", kDoor);
  ASSERT_EQ(walls.size(), 2U);
  EXPECT_EQ(walls[0].name, "north");
  EXPECT_LT((walls[0].normal_room() - Vec3(0, -1, 0)).norm(), 1e-12);
  EXPECT_LT((walls[1].normal_room() - Vec3(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((walls[0].point_room({1, 2}) - Vec3(1, 4, 2)).norm(), 1e-12);
  ASSERT_EQ(walls[0].keep_out_m.size(), 1U);
  EXPECT_EQ(walls[0].keep_out_m[0].max(), Vec2(1.4, 2.0));
}

TEST(ReadWalls, EachMistake_IsNamedWithItsLine) {
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string text = kDoor;
    text.replace(text.find(from), from.size(), to);
    return test::refusal([&] { static_cast<void>(read_walls("w.yaml", text)); });
  };
  for (const auto& [from, to, part] : {std::tuple{"[3, 2.7]", "[3, 0]", "size"},
                                       {"[3, 2.7]", "[3]", "size"},
                                       {"[2, 0, 0]", "[0, 0, 0]", "no direction"},
                                       {"[2, 0, 0]", "[0, 0, 1]", "right angle"},
                                       {"[0.5, 0, 1.4, 2.0]", "[1.4, 0, 0.5, 2.0]", "left < right"},
                                       {"corner: [0, 4, 0]", "corner: [0, .nan, 0]", "corner"},
                                       {"keep_out", "keepout", "keepout"},
                                       {"name: north", "size: [1, 1]", "size"},
                                       {"walls:", "wals:", "wals"}}) {
    const std::string message = changed(from, to);
    EXPECT_TRUE(test::contains(message, "w.yaml:") && test::contains(message, part)) << to << ": " << message;
  }
  EXPECT_NE(test::refusal([] { static_cast<void>(read_walls("w.yaml", "walls: []")); }), "");
  EXPECT_NE(test::refusal([] { static_cast<void>(read_walls("w.yaml", "")); }), "");
}

}  // namespace
}  // namespace roomcal::tools
