// NEES: the squared error in units of its predicted covariance must be chi-square distributed (Bar-Shalom, Li,
// Kirubarajan, "Estimation with Applications to Tracking and Navigation", section 5.4). All extrinsics of the device
// together are held to the two-sided 95 % band of the mean over 500 shots, and so is the family of its pairs.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/runtime/rig/shot.h"

namespace roomcal::rig {
namespace {

using test::pose_error;
using test::Shot;
using test::ShotOptions;
using test::Solver;

constexpr int kShots = 500;

// Standard normal deviate of a two-sided 95 % band for 1, 3 or 6 pairs that must all stay inside (Sidak): with a band
// of 95 % for each of six, honest code would fail one run in four.
double deviate(std::size_t pairs) { return pairs == 1 ? 1.960 : pairs == 3 ? 2.388 : 2.631; }

// Quantile of chi-square with k degrees of freedom at a standard normal deviate (Wilson, Hilferty 1931).
double chi_square_quantile(double k, double z) { return k * std::pow(1 - 2 / (9 * k) + z * std::sqrt(2 / (9 * k)), 3); }

double nees(const Eigen::VectorXd& error, const Eigen::MatrixXd& cov) { return error.dot(cov.ldlt().solve(error)); }

// Error of every extrinsic T_0_b, b >= 1, stacked, and the joint covariance: xi_b - Ad(T_b_0) xi_0.
double joint_nees(const RigSolution& solution, const Shot& shot) {
  const auto n = static_cast<Eigen::Index>(shot.device.size());
  Eigen::MatrixXd cov(6 * n, 6 * n), J = Eigen::MatrixXd::Zero(6 * (n - 1), 6 * n);
  Eigen::VectorXd error(6 * (n - 1));
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      cov.block<6, 6>(6 * i, 6 * j) = solution.cov_block(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
  for (Eigen::Index b = 1; b < n; ++b) {
    const auto k = static_cast<std::size_t>(b);
    const RelativePose relative = relative_pose(solution, 0, k);
    J.block<6, 6>(6 * (b - 1), 0) = -se3_adjoint(relative.T_a_b.inverse());
    J.block<6, 6>(6 * (b - 1), 6 * b).setIdentity();
    const SE3 truth = shot.device[0].T_rig_cam.inverse() * shot.device[k].T_rig_cam;
    error.segment<6>(6 * (b - 1)) = pose_error(relative.T_a_b, truth);
  }
  return nees(error, J * cov * J.transpose());
}

struct MeanNees {
  std::vector<double> pairs;
  double joint = 0;
  double lens = 0;  ///< of the refined parameters of one camera, mean over cameras
};

double lens_nees(const RigSolution& solution, const Shot& shot) {
  double sum = 0;
  for (std::size_t k = 0; k < solution.lenses.size(); ++k) {
    const RefinedLens& lens = solution.lenses[k];
    const camera::Parameters error = camera::parameters_of(shot.device[lens.view].camera.intrinsics()) -
                                     camera::parameters_of(lens.camera.intrinsics());
    // In prior sigmas: the parameters' units differ by eight orders.
    const camera::Parameters unit = lens.prior_sigma.cwiseInverse();
    sum += nees(unit.cwiseProduct(error), unit.asDiagonal() * solution.cov_lens(k) * unit.asDiagonal());
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, solution.lenses.size()));
}

// Fewer than six markers are never a located camera's.
bool sees_too_little(const Shot& shot) {
  return std::any_of(shot.observations.begin(), shot.observations.end(), [](const auto& o) { return o.size() < 6; });
}

// Every shot has a device, a standpoint and noise of its own.
MeanNees run_shots(uint64_t seed, const ShotOptions& options) {
  truth::Random random(seed);
  const auto room = truth::make_room(random);
  MeanNees mean;
  mean.pairs.resize(options.cameras * (options.cameras - 1) / 2);
  for (int i = 0; i < kShots; ++i) {
    Solver solver;
    Shot shot = test::make_shot(random, room, options);
    while (sees_too_little(shot)) shot = test::make_shot(random, room, options);
    const Status status = solver.solve(shot);
    EXPECT_TRUE(status.ok()) << status.detail();
    if (!status.ok()) return mean;
    mean.joint += joint_nees(solver.solution, shot) / kShots;
    mean.lens += lens_nees(solver.solution, shot) / kShots;
    std::size_t pair = 0;
    for (std::size_t a = 0; a < options.cameras; ++a)
      for (std::size_t b = a + 1; b < options.cameras; ++b, ++pair) {
        const RelativePose relative = relative_pose(solver.solution, a, b);
        const SE3 truth = shot.device[a].T_rig_cam.inverse() * shot.device[b].T_rig_cam;
        mean.pairs[pair] += nees(pose_error(relative.T_a_b, truth), relative.cov) / kShots;
      }
  }
  return mean;
}

void expect_in_band(double mean, double dimension, double z, const char* what) {
  const double low = chi_square_quantile(dimension * kShots, -z) / kShots;
  const double high = chi_square_quantile(dimension * kShots, z) / kShots;
  EXPECT_GT(mean, low) << what;
  EXPECT_LT(mean, high) << what;
  std::printf("%-24s mean NEES %7.3f, expected %2.0f, band [%.3f, %.3f]\n", what, mean, dimension, low, high);
}

void expect_consistent(uint64_t seed, const ShotOptions& options, const char* what) {
  const MeanNees mean = run_shots(seed, options);
  expect_in_band(mean.joint, 6.0 * static_cast<double>(options.cameras - 1), deviate(1), what);
  for (const double pair : mean.pairs) expect_in_band(pair, 6, deviate(mean.pairs.size()), "  a pair");
  if (mean.lens > 0) expect_in_band(mean.lens, camera::kIntrinsicsCount, deviate(1), "  lenses");
}

TEST(Consistency, ExactMap_NeesOfEveryPairIsInItsBand) { expect_consistent(101, {}, "robot, exact map"); }

TEST(Consistency, MapOfFiveMillimetres_NeesOfEveryPairIsInItsBand) {
  ShotOptions options;
  options.map_cov_m2 = 25e-6 * Mat33::Identity();
  expect_consistent(102, options, "robot, map of 5 mm");
}

TEST(Consistency, FisheyeWithSharedMarkers_NeesOfEveryPairIsInItsBand) {
  ShotOptions options;
  options.cameras = 3;
  options.lens = truth::LensKind::kFisheye;
  options.max_observations = 60;
  options.map_cov_m2 = Vec3(4e-6, 9e-6, 1e-6).asDiagonal();
  expect_consistent(103, options, "fisheye, shared markers");
}

TEST(Consistency, NarrowLensesWithFewMarkers_NeesIsInItsBand) {
  ShotOptions options;
  options.cameras = 2;
  options.lens = truth::LensKind::kNarrow;
  expect_consistent(104, options, "narrow, exact map");
}

TEST(Consistency, FivePercentOutliers_NeesOfEveryPairIsInItsBand) {
  ShotOptions options;
  options.outlier_fraction = 0.05;
  expect_consistent(105, options, "robot, 5 % outliers");
}

TEST(Consistency, RefinedIntrinsicsDrawnFromThePrior_NeesOfEveryPairIsInItsBand) {
  ShotOptions options;
  options.intrinsics_sigma = {1.2, 1.0, 0.5};
  expect_consistent(106, options, "robot, lenses refined");
  options.map_cov_m2 = 4e-6 * Mat33::Identity();
  expect_consistent(107, options, "refined, map of 2 mm");
}

TEST(Consistency, RefinedNarrowLenses_NeesIsInItsBand) {
  ShotOptions options;
  options.cameras = 2;
  options.lens = truth::LensKind::kNarrow;
  options.intrinsics_sigma = {3.5, 1.0, 0.5};
  expect_consistent(108, options, "narrow, lenses refined");
}

}  // namespace
}  // namespace roomcal::rig
