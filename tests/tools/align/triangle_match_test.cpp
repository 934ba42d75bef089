#include "tools/align/triangle_match.h"

#include <gtest/gtest.h>

#include "tests/truth/synthetic_room.h"

namespace roomcal::tools {
namespace {

const SE3 kT_a_b = se3_exp((Vec6() << 0.3, -1.2, 0.7, 0.4, 2.0, -1.1).finished());
constexpr double kNoise_m = 0.003;

std::vector<SpacePoint> room_points(truth::Random& random, std::size_t count) {
  std::vector<SpacePoint> points;
  for (const truth::RoomMarker& marker : truth::make_room(random, count)) {
    points.push_back({marker.p_room, kNoise_m * kNoise_m * Mat33::Identity()});
  }
  return points;
}

/// The points in b's frame, with noise, from the last to the first.
std::vector<SpacePoint> seen_from_b(truth::Random& random, std::span<const SpacePoint> a) {
  std::vector<SpacePoint> b;
  for (std::size_t i = a.size(); i-- > 0;) {
    b.push_back({kT_a_b.inverse() * a[i].p + kNoise_m * random.normals<3>(), a[i].cov_m2});
  }
  return b;
}

TEST(TriangleMatch, NoisyCopyInAnotherOrder_IsFound) {
  truth::Random random(1);
  const std::vector<SpacePoint> a = room_points(random, 100);
  const std::vector<SpacePoint> b = seen_from_b(random, a);
  const auto match = match_points(a, b, {});
  ASSERT_TRUE(match);
  EXPECT_GE(match->pairs.size(), 98U);
  for (const auto& [i, j] : match->pairs) EXPECT_EQ(i, a.size() - 1 - j);
  EXPECT_LT((match->T_a_b.t - kT_a_b.t).norm(), 0.005);
}

TEST(TriangleMatch, SmallPartOfARoom_FindsItsPlace) {
  truth::Random random(2);
  const std::vector<SpacePoint> a = room_points(random, 300);
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if ((a[i].p - a[7].p).norm() < 0.7) near.push_back(i);
  }
  ASSERT_GE(near.size(), 6U);
  std::vector<SpacePoint> part;
  for (const std::size_t i : near) part.push_back(a[i]);
  const auto match = match_points(a, seen_from_b(random, part), {});
  ASSERT_TRUE(match);
  EXPECT_EQ(match->pairs.size(), near.size());
  EXPECT_LT(match->second_best, match->pairs.size());
  for (const auto& [i, j] : match->pairs) EXPECT_EQ(i, near[near.size() - 1 - j]);
}

TEST(TriangleMatch, AnotherRoom_HasFewPairsAndARunnerUp) {
  truth::Random random(3), other(4);
  const auto match = match_points(room_points(random, 100), room_points(other, 100), {});
  EXPECT_LT(match ? match->pairs.size() : 0U, 30U);
}

TEST(TriangleMatch, FewerThanThreePoints_IsNoMatch) {
  truth::Random random(5);
  const std::vector<SpacePoint> a = room_points(random, 30);
  EXPECT_FALSE(match_points(a, std::span(a).first(2), {}));
  EXPECT_FALSE(match_points(std::span(a).first(2), a, {}));
}

TEST(TriangleMatch, SameInput_GivesTheSameBytes) {
  truth::Random random(6);
  const std::vector<SpacePoint> a = room_points(random, 60);
  const std::vector<SpacePoint> b = seen_from_b(random, a);
  const auto first = match_points(a, b, {}), second = match_points(a, b, {});
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->T_a_b.t, second->T_a_b.t);
  EXPECT_EQ(first->T_a_b.R, second->T_a_b.R);
}

}  // namespace
}  // namespace roomcal::tools
