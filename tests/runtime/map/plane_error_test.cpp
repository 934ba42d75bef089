#include "runtime/map/plane_error.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/truth/random.h"

namespace roomcal::map {
namespace {

TEST(PlaneAxes, AnyNormal_GivesARightHandedTriad) {
  truth::Random random(3);
  for (int i = 0; i < 200; ++i) {
    Vec3 normal = random.normals<3>().normalized();
    if (i < 3) normal = Vec3::Unit(i);
    Mat33 triad;
    triad << plane_axes(normal), normal;
    EXPECT_LT((triad.transpose() * triad - Mat33::Identity()).norm(), 1e-14);
    EXPECT_NEAR(triad.determinant(), 1, 1e-14);
  }
}

TEST(PlaneLever, SmallError_MovesSignedDistancesByItsProduct) {
  truth::Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Vec3 normal = random.normals<3>().normalized(), delta = 1e-6 * random.normals<3>();
    const double d_m = random.normals<1>()[0];
    // The plane that is off by delta: the normal tilts, the distance at the origin changes.
    const Mat32 axes = plane_axes(normal);
    const Vec3 tilted = (normal + axes.col(0) * delta[1] + axes.col(1) * delta[2]).normalized();
    Vec3 p = 3 * random.normals<3>();
    p -= (normal.dot(p) + d_m) * normal;  // on the plane
    EXPECT_NEAR(tilted.dot(p) + d_m + delta[0], plane_lever(normal, p).dot(delta), 1e-10);
  }
}

}  // namespace
}  // namespace roomcal::map
