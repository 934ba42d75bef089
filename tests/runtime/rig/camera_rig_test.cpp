#include "runtime/rig/camera_rig.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/runtime/rig/shot.h"

namespace roomcal::rig {
namespace {

using test::pose_error;
using test::Shot;
using test::ShotOptions;
using test::Solver;

constexpr truth::LensKind kAllLenses[] = {truth::LensKind::kNarrow, truth::LensKind::kWide, truth::LensKind::kFisheye};

TEST(SolveCameras, NoiseFreeShot_IsExact) {
  truth::Random random(11);
  const auto room = truth::make_room(random);
  for (const auto lens : kAllLenses) {
    for (const std::size_t cameras : {1U, 2U, 4U, 8U}) {
      ShotOptions options;
      options.cameras = cameras;
      options.lens = lens;
      options.draw_noise = false;
      options.start_sigma_m = 0.05;
      options.start_sigma_rad = 0.05;
      const Shot shot = test::make_shot(random, room, options);
      Solver solver;
      ASSERT_TRUE(solver.solve(shot).ok());
      for (std::size_t i = 0; i < cameras; ++i) {
        EXPECT_LT(pose_error(solver.solution.T_room_sensor[i], shot.T_room_cam[i]).norm(), 1e-9);
        EXPECT_LT(solver.solution.rms_px[i], 1e-8);
        EXPECT_EQ(solver.solution.outliers[i], 0);
      }
      EXPECT_EQ(solver.solution.stop, StopReason::kConverged);
      EXPECT_LT(solver.solution.iterations, 15);
    }
  }
}

TEST(SolveCameras, NoiseFreeShotWithMapCovariance_IsExactToo) {
  truth::Random random(12);
  const auto room = truth::make_room(random);
  ShotOptions options;
  options.draw_noise = false;
  Shot shot = test::make_shot(random, room, options);
  for (Landmark& landmark : shot.landmarks) landmark.cov_m2 = 25e-6 * Mat33::Identity();
  Solver solver;
  ASSERT_TRUE(solver.solve(shot).ok());
  for (std::size_t i = 0; i < shot.device.size(); ++i)
    EXPECT_LT(pose_error(solver.solution.T_room_sensor[i], shot.T_room_cam[i]).norm(), 1e-9);
}

TEST(SolveCameras, RingsFarBetterThanTheMap_ConvergesAsFast) {
  truth::Random random(62);
  const auto room = truth::make_room(random);
  ShotOptions options;
  options.cameras = 2;
  options.lens = truth::LensKind::kNarrow;
  options.min_sigma_px = 0.002;
  options.max_sigma_px = 0.004;
  options.map_cov_m2 = 1e-4 * Mat33::Identity();
  constexpr int kShots = 40;
  double nees = 0;
  for (int i = 0; i < kShots; ++i) {
    const Shot shot = test::make_shot(random, room, options);
    Solver solver;
    ASSERT_TRUE(solver.solve(shot).ok()) << "shot " << i;
    EXPECT_LT(solver.solution.iterations, 25);
    for (std::size_t k = 0; k < 2; ++k) {
      const Vec6 off = pose_error(solver.solution.T_room_sensor[k], shot.T_room_cam[k]);
      nees += off.dot(solver.solution.cov_block(k, k).ldlt().solve(off)) / (2 * kShots);
    }
  }
  EXPECT_NEAR(nees, 6, 4 * std::sqrt(12.0 / (2 * kShots)));
}

TEST(SolveCameras, Chi2_FollowsItsDegreesOfFreedom) {
  truth::Random random(13);
  const auto room = truth::make_room(random);
  for (const double map_sigma_m : {0.0, 0.005}) {
    ShotOptions options;
    options.map_cov_m2 = map_sigma_m * map_sigma_m * Mat33::Identity();
    double chi2 = 0, degrees = 0;
    Solver solver;
    for (int i = 0; i < 50; ++i) {
      ASSERT_TRUE(solver.solve(test::make_shot(random, room, options)).ok());
      chi2 += solver.solution.chi2;
      degrees += solver.solution.degrees_of_freedom;
    }
    EXPECT_NEAR(chi2 / degrees, 1, 3 * std::sqrt(2 / degrees)) << map_sigma_m;
  }
}

TEST(SolveCameras, Scatter_MeetsThePredictedCovariance) {
  // Cramer-Rao: over many draws about one truth, the covariance of the estimates is the inverse of the information.
  truth::Random random(14);
  const auto room = truth::make_room(random);
  for (const double map_sigma_m : {0.0, 0.005}) {
    ShotOptions options;
    options.map_cov_m2 = map_sigma_m * map_sigma_m * Mat33::Identity();
    options.cameras = 2;
    Shot shot = test::make_shot(random, room, options);
    const int draws = 600;
    Mat66 scatter = Mat66::Zero(), predicted = Mat66::Zero();
    Vec6 mean = Vec6::Zero();
    Solver solver;
    for (int i = 0; i < draws; ++i) {
      test::redraw(random, room, options, shot);
      ASSERT_TRUE(solver.solve(shot).ok());
      const Vec6 error = pose_error(solver.solution.T_room_sensor[0], shot.T_room_cam[0]);
      scatter += error * error.transpose() / draws;
      predicted += solver.solution.cov_block(0, 0) / draws;
      mean += error / draws;
    }
    // A variance from 600 draws is known to sqrt(2 / 600) = 5.8 %: four of those, on six directions.
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(scatter(k, k) / predicted(k, k), 1, 4 * std::sqrt(2.0 / draws)) << map_sigma_m << " " << k;
      EXPECT_LT(std::abs(mean[k]), 4 * std::sqrt(predicted(k, k) / draws)) << map_sigma_m << " " << k;
    }
  }
}

TEST(SolveCameras, FivePercentGrossOutliers_AreFoundAndCostNothing) {
  truth::Random random(15);
  const auto room = truth::make_room(random);
  ShotOptions options;
  options.outlier_fraction = 0.05;
  Solver solver;
  double nees = 0, count = 0;
  for (int i = 0; i < 100; ++i) {
    const Shot shot = test::make_shot(random, room, options);
    ASSERT_TRUE(solver.solve(shot).ok());
    std::size_t found = 0;
    for (std::size_t v = 0; v < shot.device.size(); ++v) {
      found += solver.solution.outliers[v];
      const Vec6 error = pose_error(solver.solution.T_room_sensor[v], shot.T_room_cam[v]);
      nees += error.dot(solver.solution.cov_block(v, v).ldlt().solve(error));
      ++count;
    }
    EXPECT_EQ(found, shot.outliers);
    EXPECT_LT(solver.solution.chi2, 1.5 * solver.solution.degrees_of_freedom);
  }
  EXPECT_NEAR(nees / count, 6, 3 * std::sqrt(12 / count));
}

TEST(SolveCameras, CovariancesTooSmall_ShowInChi2InsteadOfOutliers) {
  truth::Random random(16);
  const auto room = truth::make_room(random);
  Shot shot = test::make_shot(random, room, {});
  for (auto& list : shot.observations)
    for (RingObservation& observation : list) observation.cov_px2 /= 100;
  Solver solver;
  ASSERT_TRUE(solver.solve(shot).ok());
  EXPECT_NEAR(solver.solution.chi2 / solver.solution.degrees_of_freedom, 100, 15);
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_LE(solver.solution.outliers[v], 1);
    EXPECT_LT(pose_error(solver.solution.T_room_sensor[v], shot.T_room_cam[v]).norm(), 2e-3);
  }
}

TEST(SolveCameras, SigmaFloor_AddsInQuadrature) {
  truth::Random random(17);
  const auto room = truth::make_room(random);
  Shot shot = test::make_shot(random, room, {});
  SolveOptions floor;
  floor.sigma_floor_px = 0.3;
  Solver with_floor, widened;
  ASSERT_TRUE(with_floor.solve(shot, floor).ok());
  for (auto& list : shot.observations)
    for (RingObservation& observation : list) observation.cov_px2 += 0.09 * Mat22::Identity();
  ASSERT_TRUE(widened.solve(shot).ok());
  EXPECT_LT((with_floor.solution.cov_block(1, 1) - widened.solution.cov_block(1, 1)).norm(), 1e-18);
}

TEST(SolveCameras, SharedUncertainMarkers_CorrelateTheCameras) {
  truth::Random random(18);
  const auto room = truth::make_room(random);
  ShotOptions options;
  options.cameras = 8;  // neighbours overlap
  options.map_cov_m2 = 25e-6 * Mat33::Identity();
  Shot shot = test::make_shot(random, room, options);
  Solver solver;
  ASSERT_TRUE(solver.solve(shot).ok());
  const RigSolution& solution = solver.solution;
  EXPECT_GT(solution.cov_block(0, 1).norm(), 0.05 * solution.cov_block(0, 0).norm());
  EXPECT_LT((solution.cov_block(0, 1) - solution.cov_block(1, 0).transpose()).norm(), 1e-20);
  for (Landmark& landmark : shot.landmarks) landmark.cov_m2.setZero();
  ASSERT_TRUE(solver.solve(shot).ok());
  EXPECT_EQ(solver.solution.cov_block(0, 1).norm(), 0);
}

TEST(SolveCameras, SameShotTwice_GivesTheSameBytes) {
  truth::Random random(19);
  const auto room = truth::make_room(random);
  ShotOptions options;
  options.map_cov_m2 = 1e-6 * Mat33::Identity();
  const Shot shot = test::make_shot(random, room, options);
  Solver first, second;
  ASSERT_TRUE(first.solve(shot).ok());
  ASSERT_TRUE(second.solve(shot).ok());
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(first.solution.T_room_sensor[i].t, second.solution.T_room_sensor[i].t);
  EXPECT_EQ(first.solution.cov_block(2, 1), second.solution.cov_block(2, 1));
}

}  // namespace
}  // namespace roomcal::rig
