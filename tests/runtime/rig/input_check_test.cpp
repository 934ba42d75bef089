#include "runtime/rig/input_check.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/truth/synthetic_room.h"

namespace roomcal::rig {
namespace {

TEST(CovarianceRoot, FullRank_MultipliesBack) {
  truth::Random random(3);
  for (int i = 0; i < 100; ++i) {
    Mat33 B;
    for (int j = 0; j < 3; ++j) B.col(j) = random.normals<3>();
    const Mat33 cov = 1e-6 * B * B.transpose();
    Mat33 L;
    ASSERT_TRUE(covariance_root(cov, L));
    EXPECT_LT((L * L.transpose() - cov).norm(), 1e-9 * cov.norm());
  }
}

TEST(CovarianceRoot, FlatOrZero_IsAccepted) {
  Mat33 L;
  ASSERT_TRUE(covariance_root(Mat33::Zero(), L));
  EXPECT_TRUE(L.isZero(0));
  const Vec3 direction = Vec3(1, -2, 0.5).normalized();
  const Mat33 across_a_plane = 1e-6 * direction * direction.transpose();
  ASSERT_TRUE(covariance_root(across_a_plane, L));
  EXPECT_LT((L * L.transpose() - across_a_plane).norm(), 1e-14);
  const Mat33 in_a_plane = 1e-6 * (Mat33::Identity() - direction * direction.transpose());
  ASSERT_TRUE(covariance_root(in_a_plane, L));
  EXPECT_LT((L * L.transpose() - in_a_plane).norm(), 1e-13);
}

TEST(CovarianceRoot, NegativeAsymmetricOrNotANumber_IsRefused) {
  Mat33 L;
  EXPECT_FALSE(covariance_root(-1e-6 * Mat33::Identity(), L));
  Mat33 indefinite = 1e-6 * Mat33::Identity();
  indefinite(0, 1) = indefinite(1, 0) = 2e-6;
  EXPECT_FALSE(covariance_root(indefinite, L));
  Mat33 without_extent = Vec3(0, 1e-6, 1e-6).asDiagonal();
  without_extent(0, 1) = without_extent(1, 0) = 5e-7;
  EXPECT_FALSE(covariance_root(without_extent, L));
  Mat33 lopsided = 1e-6 * Mat33::Identity();
  lopsided(0, 1) = 1e-7;
  EXPECT_FALSE(covariance_root(lopsided, L));
  Mat33 nan = 1e-6 * Mat33::Identity();
  nan(2, 2) = std::nan("");
  EXPECT_FALSE(covariance_root(nan, L));
}

TEST(Whitening, Square_IsTheInverseCovariance) {
  truth::Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Mat22 cov = truth::random_cov_px2(random, 0.02, 0.4);
    Mat22 W;
    ASSERT_TRUE(whitening(cov, W));
    EXPECT_LT((W * cov * W.transpose() - Mat22::Identity()).norm(), 1e-12);
    EXPECT_LT((W.transpose() * W * cov - Mat22::Identity()).norm(), 1e-10);
  }
}

TEST(Whitening, SingularNegativeOrNotANumber_IsRefused) {
  Mat22 W;
  EXPECT_FALSE(whitening(Mat22::Zero(), W));
  EXPECT_FALSE(whitening(-Mat22::Identity(), W));
  EXPECT_FALSE(whitening(Mat22::Ones(), W));
  Mat22 nan = Mat22::Identity();
  nan(1, 0) = std::nan("");
  EXPECT_FALSE(whitening(nan, W));
  nan = Mat22::Identity();
  nan(0, 0) = INFINITY;
  EXPECT_FALSE(whitening(nan, W));
}

}  // namespace
}  // namespace roomcal::rig
