// Intrinsics refined along with the poses, from the public door.

#include <cmath>
#include <cstdio>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "runtime/rig/reprojection.h"
#include "tests/runtime/rig/shot.h"

namespace roomcal::rig {
namespace {

using Index = Eigen::Index;
using test::pose_error;
using test::Shot;
using test::ShotOptions;
using test::Solver;

/// What a calibration board leaves: 0.2 % of the focal length, a pixel of the principal point.
camera::IntrinsicsSigma usual(truth::LensKind lens) {
  return camera::usual_sigma(truth::make_camera(lens).intrinsics());
}

double position_error(const RigSolution& solution, const Shot& shot, std::size_t b) {
  const SE3 truth = shot.device[0].T_rig_cam.inverse() * shot.device[b].T_rig_cam;
  return pose_error(relative_pose(solution, 0, b).T_a_b, truth).head<3>().norm();
}

TEST(RefinedLens, OffByAPixelAndAFifthOfAPercent_ComesBackToTheTruth) {
  for (const truth::LensKind kind : {truth::LensKind::kNarrow, truth::LensKind::kWide, truth::LensKind::kFisheye}) {
    truth::Random random(61);
    const auto room = truth::make_room(random);
    ShotOptions options;
    options.cameras = 2;
    options.lens = kind;
    options.draw_noise = false;
    Shot shot = test::make_shot(random, room, options);
    for (std::size_t i = 0; i < 2; ++i) {
      camera::Intrinsics off = shot.device[i].camera.intrinsics();
      off.fx_px *= 1.002;
      off.fy_px *= 1.002;
      off.cx_px += 1;
      off.cy_px -= 1;
      shot.given[i] = camera::Camera::create(off).value();
    }
    Solver held, refined;
    ASSERT_TRUE(held.solve(shot).ok());
    for (std::size_t i = 0; i < 2; ++i) shot.intrinsics_sigma[i] = parameter_sigmas(shot.given[i], usual(kind));
    const Status status = refined.solve(shot);
    ASSERT_TRUE(status.ok()) << status.detail();
    ASSERT_EQ(refined.solution.lenses.size(), 2U);
    // The rings are exact, so only the prior pulls: by less than what it says it leaves.
    for (const RefinedLens& lens : refined.solution.lenses) {
      const camera::Parameters truth = camera::parameters_of(shot.device[lens.view].camera.intrinsics());
      const camera::Parameters left = camera::parameters_of(lens.camera.intrinsics()) - truth;
      for (Index k = 0; k < camera::kIntrinsicsCount; ++k) EXPECT_LT(std::abs(left[k]), 2 * lens.sigma[k]) << k;
    }
    const double before = position_error(held.solution, shot, 1), after = position_error(refined.solution, shot, 1);
    const double sigma_m = std::sqrt(relative_pose(refined.solution, 0, 1).cov.topLeftCorner<3, 3>().trace());
    std::printf("intrinsics off by 0.2 %% and 1 px: held %.3f mm, refined %.3f mm, 1-sigma %.3f mm\n", 1e3 * before,
                1e3 * after, 1e3 * sigma_m);
    EXPECT_LT(after, 2 * sigma_m);
    // A narrow lens and a dozen markers do not tell its focal length from its place: there the covariance says so.
    EXPECT_LT(after, kind == truth::LensKind::kNarrow ? before : 0.2 * before);
  }
}

TEST(RefinedLens, Report_TellsWhatTheShotToldAndWhatThePriorDid) {
  truth::Random random(62);
  const auto room = truth::make_room(random);
  ShotOptions options;
  options.cameras = 2;
  options.intrinsics_sigma = usual(options.lens);
  const Shot shot = test::make_shot(random, room, options);
  Solver solver;
  ASSERT_TRUE(solver.solve(shot).ok());
  const RefinedLens* lens = solver.solution.lens_of(1);
  ASSERT_NE(lens, nullptr);
  EXPECT_EQ(lens->prior, camera::parameters_of(shot.given[1].intrinsics()));
  EXPECT_EQ(lens->prior_sigma, shot.intrinsics_sigma[1]);
  for (Index k = 0; k < camera::kIntrinsicsCount; ++k) {
    EXPECT_GT(lens->sigma[k], 0);
    EXPECT_LE(lens->sigma[k], lens->prior_sigma[k] * (1 + 1e-9)) << k;
  }
  EXPECT_TRUE(lens->told_by_shot(0));  // eighty markers at 0.1 px tell a focal length better than 0.2 %
  EXPECT_TRUE(lens->told_by_shot(4));
  RefinedLens known = *lens;
  known.prior_sigma[0] = lens->sigma[0];
  EXPECT_FALSE(known.told_by_shot(0));
  known.prior_sigma[0] = known.sigma[0] = 0;
  EXPECT_FALSE(known.told_by_shot(0));
}

TEST(RefinedLens, HeldParameters_StayAndCostNothing) {
  truth::Random random(63);
  const auto room = truth::make_room(random);
  ShotOptions options;
  options.cameras = 2;
  Shot shot = test::make_shot(random, room, options);
  Solver held, nearly;
  ASSERT_TRUE(held.solve(shot).ok());
  EXPECT_TRUE(held.solution.lenses.empty());
  EXPECT_EQ(held.solution.lens_of(0), nullptr);
  shot.intrinsics_sigma[0][2] = 1e-9;
  ASSERT_TRUE(nearly.solve(shot).ok());
  ASSERT_EQ(nearly.solution.lenses.size(), 1U);
  EXPECT_EQ(nearly.solution.lenses[0].camera.intrinsics().fx_px, shot.given[0].intrinsics().fx_px);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT(pose_error(held.solution.T_room_sensor[i], nearly.solution.T_room_sensor[i]).norm(), 1e-9);
    const Mat66 cov = held.solution.cov_block(i, i);
    EXPECT_LT((cov - nearly.solution.cov_block(i, i)).norm(), 1e-6 * cov.norm());
  }
}

TEST(RefinedLens, SigmaThatIsNone_IsRefused) {
  truth::Random random(64);
  const auto room = truth::make_room(random);
  Shot shot = test::make_shot(random, room, {});
  for (const double sigma : {-1.0, std::nan(""), HUGE_VAL}) {
    shot.intrinsics_sigma[1][3] = sigma;
    Solver solver;
    EXPECT_EQ(solver.solve(shot).code(), StatusCode::kInvalidArgument);
  }
}

/// Fisher information of poses, lenses and map points at the truth, by differences of the residuals alone.
class NumericInformation {
 public:
  explicit NumericInformation(const Shot& shot) : shot_(shot) {
    const auto all = static_cast<Index>(14 * shot.device.size() + 3 * shot.landmarks.size());
    H_ = Eigen::MatrixXd::Zero(all, all);
    for (std::size_t i = 0; i < shot.device.size(); ++i) {
      for (Index k = 0; k < 8; ++k)
        H_(lens(i) + k, lens(i) + k) += 1 / (shot.intrinsics_sigma[i][k] * shot.intrinsics_sigma[i][k]);
      for (const RingObservation& ring : shot.observations[i]) add(i, ring);
    }
    const Mat33 prior = shot.landmarks[0].cov_m2.inverse();
    for (std::size_t l = 0; l < shot.landmarks.size(); ++l) H_.block<3, 3>(point(l), point(l)) += prior;
  }

  Eigen::MatrixXd covariance() const {
    return H_.ldlt().solve(Eigen::MatrixXd::Identity(H_.rows(), H_.cols())).topLeftCorner(point(0), point(0));
  }

 private:
  Index lens(std::size_t i) const { return static_cast<Index>(6 * shot_.device.size() + 8 * i); }
  Index point(std::size_t l) const { return static_cast<Index>(14 * shot_.device.size() + 3 * l); }

  Vec2 residual(std::size_t i, const RingObservation& ring, const Vec6& xi, const camera::Parameters& k,
                const Vec3& p) const {
    const camera::Intrinsics& true_lens = shot_.device[i].camera.intrinsics();
    const camera::Camera camera =
        camera::Camera::create(camera::with_parameters(true_lens, camera::parameters_of(true_lens) + k)).value();
    Vec2 out;
    EXPECT_TRUE(reproject(camera, shot_.T_room_cam[i] * se3_exp(xi), shot_.landmarks[ring.landmark].p_room + p,
                          ring.centre_px, out)
                    .ok());
    return out;
  }

  void add(std::size_t i, const RingObservation& ring) {
    Eigen::MatrixXd J(2, 17);
    for (Index c = 0; c < 17; ++c) {
      const double h = c >= 6 && c < 14 ? 1e-3 * shot_.intrinsics_sigma[i][c - 6] : 1e-6;
      const auto at = [&](double move) {
        Eigen::Matrix<double, 17, 1> x = Eigen::Matrix<double, 17, 1>::Zero();
        x[c] = move;
        return residual(i, ring, x.head<6>(), x.segment<8>(6), x.tail<3>());
      };
      J.col(c) = (at(h) - at(-h)) / (2 * h);
    }
    const Eigen::MatrixXd I = J.transpose() * ring.cov_px2.inverse() * J;
    const Index from[] = {static_cast<Index>(6 * i), lens(i), point(ring.landmark)};
    const Index width[] = {6, 8, 3}, first[] = {0, 6, 14};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        H_.block(from[a], from[b], width[a], width[b]) += I.block(first[a], first[b], width[a], width[b]);
  }

  const Shot& shot_;
  Eigen::MatrixXd H_;
};

// All that is left is the bound: no noise, so that residuals and robust weights are those of the truth.
TEST(RefinedLens, JointCovariance_IsTheCramerRaoBound) {
  truth::Random random(65);
  const auto room = truth::make_room(random, 90);
  ShotOptions options;
  options.cameras = 3;
  options.lens = truth::LensKind::kFisheye;
  options.draw_noise = false;
  options.start_sigma_m = options.start_sigma_rad = 1e-4;
  Shot shot = test::make_shot(random, room, options);
  for (Landmark& landmark : shot.landmarks) landmark.cov_m2 = Vec3(4e-6, 9e-6, 1e-6).asDiagonal();
  for (std::size_t i = 0; i < 3; ++i) shot.intrinsics_sigma[i] = parameter_sigmas(shot.given[i], usual(options.lens));
  Solver solver;
  ASSERT_TRUE(solver.solve(shot).ok());
  const Eigen::MatrixXd bound = NumericInformation(shot).covariance();
  for (Index i = 0; i < bound.rows(); ++i)
    for (Index j = 0; j < bound.cols(); ++j)
      EXPECT_NEAR(solver.solution.cov_room[static_cast<std::size_t>(i * bound.cols() + j)], bound(i, j),
                  1e-5 * std::sqrt(bound(i, i) * bound(j, j)))
          << i << " " << j;
  EXPECT_EQ(solver.solution.cov_lens(2)(3, 5), solver.solution.cov_room[(18 + 16 + 3) * 42 + 18 + 16 + 5]);
  EXPECT_EQ(solver.solution.cov_pose_lens(1, 2)(3, 5), solver.solution.cov_room[(6 + 3) * 42 + 18 + 16 + 5]);
}

}  // namespace
}  // namespace roomcal::rig
