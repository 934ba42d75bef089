#include "runtime/scan/kd_tree.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/truth/random.h"

namespace roomcal::scan {
namespace {

using Cloud = std::vector<Eigen::Vector3f>;

Cloud random_cloud(std::size_t count, uint64_t seed) {
  truth::Random random(seed);
  Cloud cloud(count);
  for (Eigen::Vector3f& p : cloud) p = (2 * random.normals<3>()).cast<float>();
  return cloud;
}

/// A wall: one coordinate is the same for all, the others repeat.
Cloud grid(std::size_t side) {
  Cloud cloud;
  for (std::size_t i = 0; i < side * side; ++i) {
    cloud.emplace_back(0.05F * static_cast<float>(i % side), 1.5F, 0.05F * static_cast<float>(i / side));
  }
  return cloud;
}

std::vector<float> squares_by_hand(const Cloud& cloud, const Eigen::Vector3f& query) {
  std::vector<float> squares;
  for (const Eigen::Vector3f& p : cloud) squares.push_back((p - query).squaredNorm());
  std::sort(squares.begin(), squares.end());
  return squares;
}

void expect_same_as_by_hand(const Cloud& cloud) {
  std::vector<std::byte> bytes(KdTree::bytes(cloud.size()));
  Arena arena{bytes};
  const KdTree tree = KdTree::build(cloud, arena).value();
  truth::Random random(9);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f query = (2 * random.normals<3>()).cast<float>();
    const std::vector<float> truth = squares_by_hand(cloud, query);
    KdTree::Near nearest;
    ASSERT_TRUE(tree.nearest(query, 100, nearest));
    EXPECT_EQ(nearest.squared_m2, truth[0]);
    EXPECT_EQ((cloud[nearest.index] - query).squaredNorm(), truth[0]);
    EXPECT_FALSE(tree.nearest(query, 0.999F * std::sqrt(truth[0]), nearest));
    std::vector<KdTree::Near> near(20);
    const std::size_t count = tree.nearest(query, near);
    ASSERT_EQ(count, std::min<std::size_t>(20, cloud.size()));
    std::vector<uint32_t> indices;
    for (std::size_t k = 0; k < count; ++k) {
      EXPECT_EQ(near[k].squared_m2, truth[k]);
      EXPECT_EQ((cloud[near[k].index] - query).squaredNorm(), near[k].squared_m2);
      indices.push_back(near[k].index);
    }
    std::sort(indices.begin(), indices.end());
    EXPECT_EQ(std::adjacent_find(indices.begin(), indices.end()), indices.end());
  }
}

TEST(KdTree, AnyCloud_AnswersAreThoseOfASearchByHand) {
  for (const std::size_t count : {1U, 2U, 7U, 8U, 9U, 17U, 100U, 1000U, 3001U})
    expect_same_as_by_hand(random_cloud(count, count));
  expect_same_as_by_hand(grid(40));
  expect_same_as_by_hand(Cloud(50, Eigen::Vector3f(1, 2, 3)));  // all in one place
}

TEST(KdTree, ArenasThatAreTooSmallAndNoPoints_AreRefused) {
  const Cloud cloud = random_cloud(100, 1);
  std::vector<std::byte> bytes(KdTree::bytes(cloud.size()));
  Status status = out_of_arena("");
  std::size_t size = 0;
  for (; status.code() == StatusCode::kOutOfMemory; size += 16) {
    ASSERT_LT(size, bytes.size() + 16);
    Arena arena{std::span(bytes).first(std::min(size, bytes.size()))};
    status = KdTree::build(cloud, arena).status();
  }
  EXPECT_TRUE(status.ok());
  EXPECT_GT(size, 100 * sizeof(Eigen::Vector3f));
  Arena arena{bytes};
  EXPECT_EQ(KdTree::build({}, arena).status().code(), StatusCode::kTooFew);
  KdTree::Near near;
  EXPECT_FALSE(KdTree().nearest(Eigen::Vector3f::Zero(), 1, near));
}

}  // namespace
}  // namespace roomcal::scan
