#include "runtime/pose/image_triangles.h"

#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/truth/random.h"

namespace roomcal::pose {
namespace {

std::vector<Vec3> cap(truth::Random& random, std::size_t n, double half_angle_rad) {
  std::vector<Vec3> bearings;
  while (bearings.size() < n) {
    const Vec3 b = random.normals<3>().normalized();
    if (b.z() > std::cos(half_angle_rad)) bearings.push_back(b);
  }
  return bearings;
}

class ImageTrianglesTest : public ::testing::TestWithParam<double> {};

// On the sphere: the plane of a Delaunay triangle has all other bearings on one side (it is a face of the convex hull).
TEST_P(ImageTrianglesTest, AnyField_TrianglesAreFacesOfTheConvexHull) {
  truth::Random random(5);
  const std::vector<Vec3> bearings = cap(random, 80, deg_to_rad(GetParam()));
  std::vector<std::byte> bytes(image_triangles_bytes(bearings.size()));
  Arena arena(bytes);
  std::span<Triple> triples;
  ASSERT_TRUE(image_triangles(bearings, {}, arena, triples).ok());
  EXPECT_GT(triples.size(), 60u);
  for (const Triple& t : triples) {
    const Vec3 normal = (bearings[t[1]] - bearings[t[0]]).cross(bearings[t[2]] - bearings[t[0]]).normalized();
    double most = -1;
    double least = 1;
    for (const Vec3& b : bearings) {
      most = std::max(most, normal.dot(b - bearings[t[0]]));
      least = std::min(least, normal.dot(b - bearings[t[0]]));
    }
    EXPECT_LT(std::min(most, -least), 1e-9);
  }
}

TEST_P(ImageTrianglesTest, AnyField_FiltersAndOrientationHold) {
  truth::Random random(6);
  const std::vector<Vec3> bearings = cap(random, 80, deg_to_rad(GetParam()));
  std::vector<std::byte> bytes(image_triangles_bytes(bearings.size()));
  Arena arena(bytes);
  std::span<Triple> triples;
  ASSERT_TRUE(image_triangles(bearings, {}, arena, triples).ok());
  for (const Triple& t : triples) {
    const Vec3 corner[3] = {bearings[t[0]], bearings[t[1]], bearings[t[2]]};
    EXPECT_GT(corner[0].dot(corner[1].cross(corner[2])), 0.0);
    double shortest = 1e9;
    double longest = 0;
    for (int i = 0; i < 3; ++i) {
      const Vec3 u = corner[(i + 1) % 3] - corner[i];
      const Vec3 v = corner[(i + 2) % 3] - corner[i];
      EXPECT_GT(std::acos(u.normalized().dot(v.normalized())), deg_to_rad(20.0));
      shortest = std::min(shortest, u.norm());
      longest = std::max(longest, u.norm());
    }
    EXPECT_LT(longest, 5.0 * shortest);
  }
}

INSTANTIATE_TEST_SUITE_P(HalfAngles, ImageTrianglesTest, ::testing::Values(20.0, 60.0, 95.0, 110.0));

TEST(TriangleFilter, ThinAndLongTriangles_Fail) {
  const Vec3 a(0, 0, 1);
  EXPECT_TRUE(passes({}, a, Vec3(0.1, 0, 1), Vec3(0.05, 0.1, 1)));
  EXPECT_FALSE(passes({}, a, Vec3(0.1, 0, 1), Vec3(0.05, 0.01, 1)));        // 11 degrees
  EXPECT_FALSE(passes({0.0, 5.0}, a, Vec3(0.01, 0, 1), Vec3(0, 0.06, 1)));  // 6 to 1
  EXPECT_FALSE(passes({}, a, a, Vec3(0.1, 0, 1)));
}

}  // namespace
}  // namespace roomcal::pose
