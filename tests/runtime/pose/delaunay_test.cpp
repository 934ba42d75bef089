#include "runtime/pose/delaunay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/truth/random.h"

namespace roomcal::pose {
namespace {

class DelaunayTest : public ::testing::Test {
 protected:
  std::span<Triple> triangulate(const std::vector<Vec2>& points) {
    bytes_.resize(delaunay_bytes(points.size()));
    arena_ = Arena(bytes_);
    std::span<Triple> triples;
    EXPECT_TRUE(delaunay(points, arena_, triples).ok());
    return triples;
  }

  std::vector<std::byte> bytes_;
  Arena arena_;
};

double twice_area(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Distance of p inside the circumcircle, as a part of its radius; negative outside.
double depth_in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& p) {
  const Vec2 u = b - a;
  const Vec2 v = c - a;
  const double d = 2.0 * (u.x() * v.y() - u.y() * v.x());
  const Vec2 centre((v.y() * u.squaredNorm() - u.y() * v.squaredNorm()) / d,
                    (u.x() * v.squaredNorm() - v.x() * u.squaredNorm()) / d);
  return 1.0 - (p - a - centre).norm() / centre.norm();
}

void expect_empty_circles(const std::vector<Vec2>& points, std::span<const Triple> triples) {
  for (const Triple& t : triples) {
    ASSERT_GT(twice_area(points[t[0]], points[t[1]], points[t[2]]), 0.0);
    for (const Vec2& p : points) {
      EXPECT_LT(depth_in_circle(points[t[0]], points[t[1]], points[t[2]], p), 1e-6);
    }
  }
}

TEST_F(DelaunayTest, RandomPoints_EveryCircumcircleIsEmpty) {
  truth::Random random(1);
  for (const std::size_t n : {3u, 4u, 10u, 50u, 200u}) {
    std::vector<Vec2> points;
    for (std::size_t i = 0; i < n; ++i) points.emplace_back(random.uniform(-3, 5), random.uniform(0, 2));
    expect_empty_circles(points, triangulate(points));
  }
}

TEST_F(DelaunayTest, RandomPoints_TrianglesFillTheConvexHull) {
  truth::Random random(2);
  std::vector<Vec2> points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (int i = 0; i < 100; ++i) points.emplace_back(random.uniform(0.01, 0.99), random.uniform(0.01, 0.99));
  double area = 0;
  for (const Triple& t : triangulate(points)) area += 0.5 * twice_area(points[t[0]], points[t[1]], points[t[2]]);
  EXPECT_NEAR(area, 1.0, 0.01);  // slivers at the hull may be missing
  EXPECT_LT(area, 1.0 + 1e-12);
}

TEST_F(DelaunayTest, RegularGrid_IsTriangulatedWhole) {
  std::vector<Vec2> points;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) points.emplace_back(x, y);
  }
  const std::span<Triple> triples = triangulate(points);
  EXPECT_EQ(triples.size(), 2u * 7u * 7u);
  expect_empty_circles(points, triples);
}

TEST_F(DelaunayTest, CollinearPoints_NoTriangle) {
  std::vector<Vec2> points;
  for (int i = 0; i < 20; ++i) points.emplace_back(i, 2.0 * i);
  for (const Triple& t : triangulate(points)) {
    EXPECT_LT(std::abs(twice_area(points[t[0]], points[t[1]], points[t[2]])), 1e-9);
  }
}

TEST_F(DelaunayTest, RepeatedPoints_AreLeftOut) {
  std::vector<Vec2> points = {{0, 0}, {1, 0}, {0, 1}, {1, 0}, {0, 0}, {1, 1.1}};
  expect_empty_circles(points, triangulate(points));
}

TEST_F(DelaunayTest, FewerThanThree_Empty) {
  EXPECT_TRUE(triangulate({}).empty());
  EXPECT_TRUE(triangulate({{0, 0}, {1, 1}}).empty());
}

TEST_F(DelaunayTest, EveryArenaThatIsTooSmall_IsRefused) {
  truth::Random random(3);
  std::vector<Vec2> points;
  for (int i = 0; i < 30; ++i) points.push_back(random.normals<2>());
  bool succeeded = false;
  for (std::size_t size = 0; size <= delaunay_bytes(points.size()); size += 64) {
    std::vector<std::byte> bytes(size);
    Arena arena(bytes);
    std::span<Triple> triples;
    const Status status = delaunay(points, arena, triples);
    succeeded = status.ok();
    if (succeeded) break;
    EXPECT_EQ(status.code(), StatusCode::kOutOfMemory);
    EXPECT_TRUE(triples.empty());
  }
}

}  // namespace
}  // namespace roomcal::pose
