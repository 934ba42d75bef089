#include "runtime/rig/lidar_terms.h"

#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "tests/runtime/rig/lidar_gradient.h"
#include "tests/runtime/rig/shot.h"

namespace roomcal::rig {
namespace {

/// Four cameras with exact markers and one LiDAR, whose points leave one direction open.
struct Fixture {
  explicit Fixture(uint64_t seed) : random(seed), room(truth::make_room(random)) {
    shot = test::make_shot(random, room, {});
    T_reference_lidar = SE3{so3_exp(random.normals<3>()), 0.1 * random.normals<3>()};
    T_room_lidar = shot.T_room_cam[0] * T_reference_lidar;
    for (int i = 0; i < 5; ++i) {  // rank 5: a direction without information
      const Vec6 J = random.normals<6>();
      lidar.points.information += 1e6 * J * J.transpose();
    }
    lidar.mount = {true, T_reference_lidar, 0.008, 0.017};
  }

  /// Draws what points and mount say around the truth.
  void draw() {
    lidar.points.T_hat = T_room_lidar * se3_exp(1e-4 * random.normals<6>());
    const Vec6 off = se3_log(lidar.points.T_hat.inverse() * T_room_lidar);
    // gradient = I xi_measured, with xi_measured = truth + noise of covariance I^-1 where there is information.
    const Eigen::SelfAdjointEigenSolver<Mat66> axes(lidar.points.information);
    Vec6 noise = random.normals<6>();
    lidar.points.gradient = lidar.points.information * off;
    for (int i = 0; i < 6; ++i)
      lidar.points.gradient += std::sqrt(std::max(0.0, axes.eigenvalues()[i])) * noise[i] * axes.eigenvectors().col(i);
    Vec6 mounting = random.normals<6>();
    mounting.head<3>() *= lidar.mount.sigma_t_m;
    mounting.tail<3>() *= lidar.mount.sigma_rot_rad;
    lidar.mount.T_reference_lidar = T_reference_lidar * se3_exp(-mounting);
  }

  Status solve(bool mounted) {
    const std::vector<CameraView> views = shot.views();
    lidar.mount.known = mounted;
    Arena step{step_bytes}, scratch{scratch_bytes};
    return solve_rig({views, {&lidar, 1}, 0, shot.landmarks}, {}, step, scratch, solution);
  }

  truth::Random random;
  std::vector<truth::RoomMarker> room;
  test::Shot shot;
  SE3 T_reference_lidar, T_room_lidar;
  LidarView lidar;
  std::vector<std::byte> step_bytes = std::vector<std::byte>(1U << 20U);
  std::vector<std::byte> scratch_bytes = std::vector<std::byte>(4U << 20U);
  RigSolution solution;
};

TEST(LidarTerms, Gradient_IsHalfTheDerivativeOfTheCost) {
  Fixture f(7);
  f.draw();
  const std::vector<CameraView> views = f.shot.views();
  Arena scratch{f.scratch_bytes};
  JointProblem problem;
  NormalEquations equations;
  ASSERT_TRUE(JointProblem::build({views, {&f.lidar, 1}, 0, f.shot.landmarks}, {}, scratch, problem).ok());
  ASSERT_TRUE(NormalEquations::build(5, 0, scratch, equations).ok());
  problem.state.T_room_sensor[4] = f.T_room_lidar * se3_exp(0.05 * f.random.normals<6>());  // well away from T_hat
  add_lidars(problem, equations);
  for (std::size_t k = 0; k < 30; ++k) {
    if (k >= 6 && k < 24) continue;  // other cameras take no part
    const double numeric = test::lidar_cost_derivative(problem, 5, k);
    EXPECT_NEAR(2 * equations.gradient[k], numeric, 1e-6 * std::abs(numeric) + 1e-2) << k;
  }
}

TEST(LidarTerms, OpenDirectionWithoutMount_KeepsItsWidth) {
  Fixture f(8);
  f.draw();
  ASSERT_TRUE(f.solve(false).ok());
  const Mat66 cov = f.solution.cov_block(4, 4);
  const Eigen::SelfAdjointEigenSolver<Mat66> axes(cov);
  EXPECT_GT(std::sqrt(axes.eigenvalues()[5]), 0.3);  // between 0.5 rad and 1 m, never a number that looks good
  EXPECT_LT(std::sqrt(axes.eigenvalues()[4]), 0.02);
}

TEST(LidarTerms, Mount_CarriesTheOpenDirection) {
  Fixture f(9);
  f.draw();
  ASSERT_TRUE(f.solve(true).ok());
  const RelativePose pair = relative_pose(f.solution, 0, 4);
  EXPECT_LT(std::sqrt(pair.cov.diagonal().maxCoeff()), 0.02);
  EXPECT_GT(std::sqrt(pair.cov.diagonal().maxCoeff()), 0.002);
}

TEST(LidarTerms, Shots_NeesOfTheCameraLidarPairIsInItsBand) {
  constexpr int kShots = 300;
  Fixture f(10);
  double nees = 0;
  for (int i = 0; i < kShots; ++i) {
    f.draw();
    test::redraw(f.random, f.room, {}, f.shot);
    ASSERT_TRUE(f.solve(true).ok());
    for (const std::size_t camera : {0U, 2U}) {
      const RelativePose pair = relative_pose(f.solution, camera, 4);
      const Vec6 error = test::pose_error(pair.T_a_b, f.shot.T_room_cam[camera].inverse() * f.T_room_lidar);
      nees += error.dot(pair.cov.ldlt().solve(error)) / (2 * kShots);
    }
  }
  EXPECT_NEAR(nees, 6, 2.6 * std::sqrt(12.0 / kShots));  // the two pairs share the LiDAR: as one
  std::printf("camera-LiDAR: mean NEES %.3f, expected 6\n", nees);
}

}  // namespace
}  // namespace roomcal::rig
