#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "runtime/rig/camera_rig.h"
#include "tests/truth/random.h"

namespace roomcal::rig {
namespace {

using Mat12 = Eigen::Matrix<double, 12, 12>;
using Vec12 = Eigen::Matrix<double, 12, 1>;

// A solution of two cameras with a given joint covariance.
struct TwoCameras {
  explicit TwoCameras(const Mat12& joint) : cov(144) {
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j) cov[static_cast<std::size_t>(12 * i + j)] = joint(i, j);
    poses[0] = se3_exp((Vec6() << 1.0, 2.0, 1.1, 0.4, -1.2, 0.7).finished());
    poses[1] = se3_exp((Vec6() << 1.3, 1.8, 0.9, -0.8, 0.3, 1.9).finished());
    solution.T_room_sensor = poses;
    solution.cov_room = cov;
  }
  std::vector<SE3> poses{2};
  std::vector<double> cov;
  RigSolution solution;
};

// Positive definite, strongly correlated, sigmas of a millimetre and a milliradian.
Mat12 correlated_covariance() {
  truth::Random random(5);
  Mat12 B;
  for (int i = 0; i < 12; ++i) B.col(i) = random.normals<12>();
  Mat12 joint = 1e-6 * (B * B.transpose() / 12 + 0.1 * Mat12::Identity());
  return joint;
}

TEST(RelativePose, Covariance_MeetsMonteCarlo) {
  const Mat12 joint = correlated_covariance();
  const TwoCameras two(joint);
  const RelativePose relative = relative_pose(two.solution, 0, 1);
  const Mat12 L = joint.llt().matrixL();
  truth::Random random(6);
  const int draws = 40000;
  Mat66 scatter = Mat66::Zero();
  for (int i = 0; i < draws; ++i) {
    const Vec12 xi = L * random.normals<12>();
    const SE3 T_room_a = two.poses[0] * se3_exp(xi.head<6>());
    const SE3 T_room_b = two.poses[1] * se3_exp(xi.tail<6>());
    const Vec6 error = se3_log(relative.T_a_b.inverse() * (T_room_a.inverse() * T_room_b));
    scatter += error * error.transpose() / draws;
  }
  // An element of a covariance from n draws scatters by sqrt((c_ii c_jj + c_ij^2) / n).
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const Mat66& C = relative.cov;
      EXPECT_NEAR(scatter(i, j), C(i, j), 4.5 * std::sqrt((C(i, i) * C(j, j) + C(i, j) * C(i, j)) / draws)) << i << j;
    }
}

TEST(RelativePose, OfACameraToItself_IsIdentityAndCertain) {
  const TwoCameras two(correlated_covariance());
  const RelativePose relative = relative_pose(two.solution, 1, 1);
  EXPECT_LT((relative.T_a_b.matrix() - Mat44::Identity()).norm(), 1e-15);
  EXPECT_LT(relative.cov.norm(), 1e-20);
}

TEST(RelativePose, CommonMotionOfBothCameras_CancelsOut) {
  // Both poses move with the room: xi_b = Ad(T_b_a) xi_a. The pair does not change.
  TwoCameras two(Mat12::Zero());
  const Mat66 Ad = se3_adjoint(two.poses[1].inverse() * two.poses[0]);
  const Mat66 cov_a = correlated_covariance().topLeftCorner<6, 6>();
  Mat12 joint;
  joint << cov_a, cov_a * Ad.transpose(), Ad * cov_a, Ad * cov_a * Ad.transpose();
  const TwoCameras moving(joint);
  EXPECT_LT(relative_pose(moving.solution, 0, 1).cov.norm(), 1e-9 * cov_a.norm());
}

TEST(RelativePose, TheOtherWayRound_IsTheAdjointCovariance) {
  const TwoCameras two(correlated_covariance());
  const RelativePose forth = relative_pose(two.solution, 0, 1), back = relative_pose(two.solution, 1, 0);
  const Mat66 Ad = se3_adjoint(forth.T_a_b);
  EXPECT_LT(((forth.T_a_b * back.T_a_b).matrix() - Mat44::Identity()).norm(), 1e-14);
  EXPECT_LT((Ad * forth.cov * Ad.transpose() - back.cov).norm(), 1e-12 * back.cov.norm());
}

}  // namespace
}  // namespace roomcal::rig
