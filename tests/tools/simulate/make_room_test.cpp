#include "tools/simulate/make_room.h"

#include <gtest/gtest.h>

#include "tools/common/error.h"
#include "tools/simulate/planar.h"

namespace roomcal::tools {
namespace {

TEST(MakeRoom, SameSeed_SameRoom) {
  const auto a = markers_of(make_room({.seed = 7})), b = markers_of(make_room({.seed = 7}));
  ASSERT_EQ(a.size(), 340u);
  ASSERT_EQ(b.size(), a.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].centre_room, b[i].centre_room);
}

TEST(MakeRoom, OtherSeed_OtherRoom) {
  const auto a = markers_of(make_room({.seed = 7})), b = markers_of(make_room({.seed = 8}));
  int equal = 0;
  for (std::size_t i = 0; i < a.size(); ++i) equal += (a[i].centre_room - b[i].centre_room).norm() < 1e-3 ? 1 : 0;
  EXPECT_EQ(equal, 0);
}

/// Whether a point of the plane lies on the sheet: checks the separating axes by brute force.
bool covers(const Decal& sheet, const Vec2& q) {
  const Vec2 d = q - sheet.centre;
  const double c = std::cos(sheet.angle_rad), s = std::sin(sheet.angle_rad);
  return std::abs(c * d.x() + s * d.y()) < sheet.half_size.x() &&
         std::abs(-s * d.x() + c * d.y()) < sheet.half_size.y();
}

TEST(MakeRoom, Sheets_DoNotOverlapAndStayOnTheirWall) {
  const Scene scene = make_room({.seed = 3, .pillar = true});
  constexpr int kSteps = 12;
  for (const Plane& wall : scene.walls) {
    for (std::size_t i = 0; i < wall.decals.size(); ++i) {
      const Decal& sheet = wall.decals[i];
      for (int k = 0; k <= kSteps * kSteps; ++k) {
        const Vec2 local(2.0 * (k % kSteps) / (kSteps - 1) - 1, 2.0 * (k / kSteps % kSteps) / (kSteps - 1) - 1);
        const double c = std::cos(sheet.angle_rad), s = std::sin(sheet.angle_rad);
        const Vec2 half = local.cwiseProduct(sheet.half_size);
        const Vec2 q = sheet.centre + Vec2(c * half.x() - s * half.y(), s * half.x() + c * half.y());
        for (const Plane& other : scene.walls) EXPECT_GT(other.signed_distance(wall.point(q)), -1e-9) << wall.name;
        for (std::size_t j = 0; j < wall.decals.size(); ++j) {
          ASSERT_FALSE(i != j && covers(wall.decals[j], q)) << wall.name << " " << i << " " << j;
        }
      }
    }
  }
}

TEST(MakeRoom, Markers_LieOnPlanesAndOutsideBodies) {
  const Scene scene = make_room({.seed = 3, .pillar = true, .boxes = 3});
  for (const SceneMarker& marker : markers_of(scene)) {
    for (const Body& body : scene.bodies) EXPECT_GT(clearance(body, marker.centre_room), marker.radius_m);
    EXPECT_NEAR(marker.normal_room.norm(), 1, 1e-12);
  }
}

TEST(MakeRoom, Polygons_AreTheRoomsCorners) {
  const Scene scene = make_room({.seed = 5});
  for (const Plane& wall : scene.walls) {
    const auto corners = polygon_of(scene, wall);
    ASSERT_EQ(corners.size(), 4u) << wall.name;
    for (const Vec3& corner : corners) EXPECT_NEAR(wall.signed_distance(corner), 0, 1e-9);
  }
}

TEST(MakeRoom, TooManySheets_SaysHowManyFit) {
  try {
    make_room({.markers = 400, .size = Vec3(2, 2, 2)});
    FAIL() << "400 sheets in 20 square metres";
  } catch (const ToolError& error) {
    EXPECT_NE(std::string(error.what()).find("sheets fit"), std::string::npos);
  }
}

TEST(MakeRoom, SizeThatIsNoRoom_IsRefused) { EXPECT_THROW(make_room({.size = Vec3(0, 4, 2)}), ToolError); }

}  // namespace
}  // namespace roomcal::tools
