#include "runtime/map/sample_surface.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/runtime/map/small_map.h"

namespace roomcal::map {
namespace {

/// A map with one square of 1 m side on the floor.
tools::AlignedBytes square_map(double spacing_m) {
  tools::MapData data = test::small_map();
  data.planes[0].outline_room = {Vec3(0.01, 0.01, 0), Vec3(1.01, 0.01, 0), Vec3(1.01, 1.01, 0), Vec3(0.01, 1.01, 0)};
  data.surface_spacing_m = spacing_m;
  return tools::build_map(data);
}

TEST(SampleSurface, Square_IsFilledOnThePlane) {
  const tools::AlignedBytes bytes = square_map(0.1);
  const RoomMap map = RoomMap::open(bytes.span()).value();
  std::vector<std::byte> memory(64 * 1024);
  Arena arena(memory);
  std::span<SurfacePoint> points;
  ASSERT_TRUE(sample_surface(map, 0, arena, points).ok());
  EXPECT_EQ(points.size(), 100U);
  EXPECT_EQ(points.size(), surface_point_count(map));
  for (const SurfacePoint& point : points) {
    EXPECT_EQ(point.plane, 0);
    EXPECT_LT(std::abs(point.p_room.z()), 1e-6F);
    EXPECT_GT(point.p_room.head<2>().minCoeff(), 0.0F);
    EXPECT_LT(point.p_room.head<2>().maxCoeff(), 1.011F);
  }
}

TEST(SampleSurface, SpacingOfTheCall_OverridesTheMaps) {
  const tools::AlignedBytes bytes = square_map(0.1);
  const RoomMap map = RoomMap::open(bytes.span()).value();
  EXPECT_EQ(surface_point_count(map, 0.2), 25U);
  EXPECT_EQ(surface_point_count(RoomMap{}), 0U);
}

TEST(SampleSurface, SpacingOutOfRange_IsRefused) {
  const tools::AlignedBytes bytes = square_map(0.1);
  const RoomMap map = RoomMap::open(bytes.span()).value();
  Arena arena;
  std::span<SurfacePoint> points;
  for (const double spacing_m : {-1.0, 1e-6, 1e6}) {
    EXPECT_EQ(sample_surface(map, spacing_m, arena, points).code(), StatusCode::kInvalidArgument);
  }
}

TEST(SampleSurface, ArenaTooSmall_IsOutOfMemoryAndEmpty) {
  const tools::AlignedBytes bytes = square_map(0.1);
  const RoomMap map = RoomMap::open(bytes.span()).value();
  std::vector<std::byte> memory(100 * sizeof(SurfacePoint) - 1);
  Arena arena(memory);
  std::span<SurfacePoint> points;
  EXPECT_EQ(sample_surface(map, 0, arena, points).code(), StatusCode::kOutOfMemory);
  EXPECT_TRUE(points.empty());
}

}  // namespace
}  // namespace roomcal::map
