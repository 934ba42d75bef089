#include "tools/align/rigid_fit.h"

#include <gtest/gtest.h>

#include "tests/truth/random.h"

namespace roomcal::tools {
namespace {

const SE3 kT_a_b = se3_exp((Vec6() << 0.3, -1.2, 0.7, 0.4, 2.0, -1.1).finished());

std::vector<Vec3> cloud(truth::Random& random, std::size_t count) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(random.normals<3>());
  return points;
}

TEST(RigidFit, ExactPoints_ReturnsTheTransform) {
  truth::Random random(1);
  const std::vector<Vec3> p_b = cloud(random, 12);
  std::vector<Vec3> p_a;
  for (const Vec3& p : p_b) p_a.push_back(kT_a_b * p);
  const SE3 T = fit_rigid(p_a, p_b);
  EXPECT_LT(se3_log(T.inverse() * kT_a_b).norm(), 1e-12);
}

TEST(RigidFit, ThreePoints_GiveARotationNotAReflection) {
  const std::vector<Vec3> p_b{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  std::vector<Vec3> p_a;
  for (const Vec3& p : p_b) p_a.push_back(kT_a_b * p);
  const SE3 T = fit_rigid(p_a, p_b);
  EXPECT_LT(se3_log(T.inverse() * kT_a_b).norm(), 1e-12);
}

TEST(RigidFit, ScaledPoints_GivesTheFactor) {
  truth::Random random(2);
  const std::vector<Vec3> p_b = cloud(random, 20);
  std::vector<Vec3> p_a;
  for (const Vec3& p : p_b) p_a.push_back(kT_a_b * Vec3(1.003 * p));
  EXPECT_NEAR(fit_scale(p_a, p_b, fit_rigid(p_a, p_b)), 1.003, 1e-12);
}

TEST(RigidFit, PointsWorseInDepth_WeightingTurnsItBetter) {
  truth::Random random(3);
  double plain2 = 0, weighted2 = 0;
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<SpacePoint> a, b;
    std::vector<Vec3> p_a, p_b;
    PointPairs pairs;
    for (std::size_t i = 0; i < 10; ++i) {
      const Mat33 cov_m2 = Vec3(1e-6, 1e-6, 4e-4).asDiagonal();
      const Vec3 p = random.normals<3>();
      b.push_back({p + cov_m2.cwiseSqrt() * random.normals<3>(), cov_m2});
      a.push_back({kT_a_b * p, 1e-8 * Mat33::Identity()});
      p_a.push_back(a.back().p);
      p_b.push_back(b.back().p);
      pairs.emplace_back(i, i);
    }
    const SE3 plain = fit_rigid(p_a, p_b);
    plain2 += se3_log(plain.inverse() * kT_a_b).tail<3>().squaredNorm();
    weighted2 += se3_log(fit_rigid_weighted(a, b, pairs, plain).inverse() * kT_a_b).tail<3>().squaredNorm();
  }
  EXPECT_LT(weighted2, 0.1 * plain2);
}

}  // namespace
}  // namespace roomcal::tools
