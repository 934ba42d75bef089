#include "tools/simulate/furniture.h"

#include <set>

#include <gtest/gtest.h>

#include "tools/simulate/make_room.h"
#include "tools/simulate/planar.h"
#include "tools/simulate/ray.h"

namespace roomcal::tools {
namespace {

Scene furnished(uint64_t seed) {
  RoomOptions options;
  options.seed = seed;
  options.furniture = 8;
  return make_room(options);
}

TEST(Furniture, Pieces_StandInTheRoomAndApart) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = furnished(seed);
    std::set<std::string> pieces;
    for (const Body& body : scene.bodies) {
      pieces.insert(body.name);
      for (const Vec3& corner : corners_of(body)) {
        for (const Plane& wall : scene.walls) EXPECT_GT(wall.signed_distance(corner), 0.004) << body.name;
        for (const Body& other : scene.bodies) {
          const double off_m = other.name == body.name ? 1 : clearance(other, corner);
          EXPECT_GT(off_m, 0) << body.name << " in " << other.name;
        }
      }
    }
    EXPECT_GE(pieces.size(), 5U);
  }
}

TEST(Furniture, Sheets_HangWhereTheyHungWithoutIt) {
  RoomOptions options;
  options.seed = 3;
  const auto with = markers_of(furnished(3)), without = markers_of(make_room(options));
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i) EXPECT_EQ(with[i].centre_room, without[i].centre_room);
}

TEST(Furniture, BallsAroundBodies_LoseNoHit) {
  const Scene scene = furnished(2);
  Random random(1);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 from(random.uniform(0.5, 2.5), random.uniform(0.5, 3.5), random.uniform(0.3, 2));
    const Vec3 along(random.normal(), random.normal(), random.normal());
    for (const Body& body : scene.bodies) {
      Body bare = body;
      bare.reach_m = std::numeric_limits<double>::infinity();
      const Hit fast = cast_at_body(body, from, along), slow = cast_at_body(bare, from, along);
      ASSERT_EQ(fast.plane == nullptr, slow.plane == nullptr);
      ASSERT_EQ(fast.distance, slow.distance);
      hits += fast.plane != nullptr ? 1 : 0;
    }
  }
  EXPECT_GT(hits, 1000);
}

}  // namespace
}  // namespace roomcal::tools
