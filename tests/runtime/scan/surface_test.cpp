#include "runtime/scan/surface.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/runtime/scan/baked_room.h"
#include "tests/runtime/scan/box.h"
#include "tests/truth/random.h"
#include "tools/simulate/make_room.h"

namespace roomcal::scan {
namespace {

using test::BakedRoom;

TEST(Surface, MapOfMarkersOnly_OutlinesReachTheEdgesOfTheRoom) {
  tools::RoomOptions options;
  options.seed = 4;
  const BakedRoom baked(tools::make_room(options));
  int walls = 0;
  for (const Face& face : baked.surface.faces()) {
    if (std::abs(face.normal_room.z()) > 0.9) continue;
    ++walls;
    // Every upright edge of a wall is an edge of the room, though the nearest marker is 0.1 to 0.5 m away.
    double low = 1e9, high = -1e9;
    const Vec3 along = Vec3::UnitZ().cross(face.normal_room).normalized();
    double bottom = 1e9;
    for (const Vec3& p : baked.surface.vertices_room(face)) {
      low = std::min(low, along.dot(p));
      high = std::max(high, along.dot(p));
      bottom = std::min(bottom, p.z());
    }
    const double width = std::abs(along.x()) > 0.7 ? 3 : 4;
    EXPECT_NEAR(high - low, width, 0.06);
    EXPECT_NEAR(bottom, 0, 0.03);
  }
  EXPECT_EQ(walls, 4);
  EXPECT_EQ(baked.surface.prints().size(), 340U);
}

TEST(Surface, WallWithoutCeiling_EndsAtItsHighestMarker) {
  for (const uint64_t seed : {4U, 5U, 8U}) {  // 5 and 8: walls that lean towards each other and meet, far above
    tools::RoomOptions options;
    options.seed = seed;
    const BakedRoom baked(tools::make_room(options));
    double highest_marker = 0;
    for (const Print& print : baked.surface.prints()) highest_marker = std::max(highest_marker, print.p_room.z());
    for (const Face& face : baked.surface.faces()) {
      for (const Vec3& p : baked.surface.vertices_room(face)) EXPECT_LE(p.z(), highest_marker + 0.06) << seed;
    }
  }
}

TEST(Surface, Vertices_GoAroundCounterClockwiseSeenFromFreeSpace) {
  tools::RoomOptions options;
  options.seed = 9;
  options.pillar = true;
  const BakedRoom baked(tools::make_room(options));
  for (const Face& face : baked.surface.faces()) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : baked.surface.vertices_room(face)) middle += p / face.count;
    for (const FaceEdge& edge : baked.surface.edges(face)) EXPECT_GT(edge.inward_room.dot(middle) + edge.d_m, 0);
  }
}

TEST(FromPolygons, PolygonsThatAreNone_AreRefused) {
  std::vector<std::byte> bytes(1 << 16);
  const std::vector<Vec3> line = {Vec3::Zero(), Vec3::UnitX(), 2 * Vec3::UnitX()};
  const std::vector<Vec3> bent = {Vec3::Zero(), Vec3::UnitX(), Vec3(1, 1, 0), Vec3(0, 1, 0.5)};
  const std::vector<Vec3> nan = {Vec3::Zero(), Vec3::UnitX(), Vec3::Constant(std::nan(""))};
  for (const auto& vertices : {line, bent, nan}) {
    Arena arena{bytes};
    const Polygon polygon{vertices};
    EXPECT_EQ(Surface::from_polygons({&polygon, 1}, {}, arena).status().code(), StatusCode::kInvalidArgument);
  }
  Arena arena{bytes};
  EXPECT_EQ(Surface::from_polygons({}, {}, arena).status().code(), StatusCode::kTooFew);
}

TEST(FromPolygons, TooManyEdgesTogether_AreRefused) {
  std::vector<Vec3> round;
  for (std::size_t i = 0; i < kMaxFaceEdges; ++i) {
    const double turn = 2 * kPi * static_cast<double>(i) / static_cast<double>(kMaxFaceEdges);
    round.emplace_back(std::cos(turn), std::sin(turn), 0);
  }
  const std::vector<Polygon> polygons(kMaxEdges / kMaxFaceEdges + 1, Polygon{round});
  std::vector<std::byte> bytes(Surface::bytes(polygons.size(), 0));
  Arena arena{bytes};
  EXPECT_EQ(Surface::from_polygons(polygons, {}, arena).status().code(), StatusCode::kCapacity);
  Arena again{bytes};
  EXPECT_TRUE(Surface::from_polygons(std::span(polygons).first(polygons.size() - 1), {}, again).ok());
}

TEST(Surface, PrintsBetween_AreThoseOfTheInterval) {
  tools::RoomOptions options;
  options.seed = 4;
  const BakedRoom baked(tools::make_room(options));
  truth::Random random(3);
  std::size_t found = 0;
  for (const Face& face : baked.surface.faces()) {
    const std::span<const Print> all = baked.surface.prints(face);
    for (int i = 0; i < 50; ++i) {
      const double low_m = random.uniform(-0.5, 3.5), high_m = low_m + random.uniform(-0.2, 1);
      const std::span<const Print> some = baked.surface.prints_between(face, low_m, high_m);
      const auto inside = [&](const Print& print) {
        const double along_m = print.p_room[face.print_axis];
        return along_m >= low_m && along_m <= high_m;
      };
      EXPECT_EQ(static_cast<std::ptrdiff_t>(some.size()), std::count_if(all.begin(), all.end(), inside));
      EXPECT_TRUE(std::all_of(some.begin(), some.end(), inside));
      found += some.size();
    }
  }
  EXPECT_GT(found, 100U);
  EXPECT_GT(baked.surface.largest_print_m(), 0.01);
}

TEST(Surface, EveryArenaThatIsTooSmall_IsRefused) {
  tools::RoomOptions options;
  options.seed = 4;
  options.markers = 40;
  const BakedRoom baked(tools::make_room(options));
  const std::size_t enough = Surface::bytes(baked.map.plane_count(), baked.map.marker_count());
  std::vector<std::byte> permanent_bytes(enough), scratch_bytes(BakedRoom::kScratchBytes);
  for (const bool starve_permanent : {true, false}) {
    std::size_t size = 0;
    Status status = out_of_arena("");
    for (; status.code() == StatusCode::kOutOfMemory; size += 64) {
      ASSERT_LE(size, starve_permanent ? enough : BakedRoom::kScratchBytes);
      Arena permanent{std::span(permanent_bytes).first(starve_permanent ? size : enough)};
      Arena scratch{std::span(scratch_bytes).first(starve_permanent ? BakedRoom::kScratchBytes : size)};
      status = Surface::build(baked.map, {}, permanent, scratch).status();
      EXPECT_EQ(scratch.used(), 0U);
    }
    EXPECT_TRUE(status.ok()) << status.detail();
    EXPECT_GT(size, 64U);
  }
}

TEST(Surface, EmptyMap_IsRefused) {
  std::vector<std::byte> bytes(1024);
  Arena permanent{bytes}, scratch;
  EXPECT_EQ(Surface::build(map::RoomMap(), {}, permanent, scratch).status().code(), StatusCode::kTooFew);
}

}  // namespace
}  // namespace roomcal::scan
