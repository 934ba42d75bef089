#include "runtime/rig/lens_terms.h"

#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/runtime/rig/shot.h"

namespace roomcal::rig {
namespace {

using Index = Eigen::Index;
constexpr Index kPoses = 18, kLenses = 16, kDense = kPoses + kLenses;

// Three cameras, two of them with lenses to refine, that share uncertain landmarks; away from the minimum.
struct Fixture {
  Fixture() : memory(4U << 20U), arena(memory) {
    truth::Random random(51);
    const auto room = truth::make_room(random, 60);
    test::ShotOptions options;
    options.cameras = 3;
    options.lens = truth::LensKind::kFisheye;
    options.map_cov_m2 = Vec3(4e-6, 25e-6, 1e-6).asDiagonal();
    options.start_sigma_m = options.start_sigma_rad = 1e-4;
    options.intrinsics_sigma = {1.0, 0.7, 0.2};
    shot = test::make_shot(random, room, options);
    shot.landmarks[3].cov_m2.setZero();
    shot.intrinsics_sigma[1].setZero();
    shot.intrinsics_sigma[2][5] = 0;  // one parameter held
    views = shot.views();
    EXPECT_TRUE(JointProblem::build({views, {}, kNoReference, shot.landmarks}, {}, arena, problem).ok());
    EXPECT_TRUE(NormalEquations::build(3, problem.lenses.size(), arena, equations).ok());
    for (Vec3& u : problem.state.u) u = 0.1 * random.normals<3>();
    for (std::size_t k = 0; k < 2; ++k) move_to(k, 0.3 * random.normals<8>(), problem.state);
    problem.linearize();
    problem.update_turn_over();
    cost = problem.reweight();
  }

  void move_to(std::size_t k, const camera::Parameters& v, State& at) const {
    const camera::Intrinsics& prior = problem.views[problem.lenses[k].view].camera->intrinsics();
    at.v[k] = v;
    at.camera[k] = camera::Camera::create(camera::with_parameters(prior, camera::parameters_of(prior) +
                                                                             problem.lenses[k].sigma.cwiseProduct(v)))
                       .value();
  }

  // The whole information and gradient, nothing eliminated: poses, lenses, then three unknowns for every landmark.
  void dense(double damping, Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
    const Index all = kDense + 3 * static_cast<Index>(problem.landmarks.size());
    H = Eigen::MatrixXd::Zero(all, all);
    g = Eigen::VectorXd::Zero(all);
    H.diagonal().tail(all - kPoses).setOnes();
    for (std::size_t k = 0; k < 2; ++k) g.segment<8>(kPoses + 8 * static_cast<Index>(k)) = problem.state.v[k];
    for (std::size_t l = 0; l < problem.landmarks.size(); ++l)
      if (!problem.landmarks[l].exact) g.segment<3>(kDense + 3 * static_cast<Index>(l)) = problem.state.u[l];
    for (std::size_t i = 0; i < problem.terms.size(); ++i) {
      const Term& term = problem.terms[i];
      const std::size_t lens = problem.views[term.view].lens;
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2, all);
      J.middleCols<6>(6 * term.view) = term.J_pose;
      if (lens != kHeldLens) J.middleCols<8>(kPoses + 8 * static_cast<Index>(lens)) = problem.J_lens[i];
      if (!problem.landmarks[term.landmark].exact) J.middleCols<3>(kDense + 3 * term.landmark) = term.J_u;
      H += term.weight * J.transpose() * J;
      g += term.weight * J.transpose() * term.r;
    }
    // The reduced system is damped, S = A - B C^-1 B^T: as much is added to A.
    const Index rest = all - kDense;
    const Eigen::MatrixXd B = H.topRightCorner(kDense, rest);
    const Eigen::MatrixXd less = B * H.bottomRightCorner(rest, rest).ldlt().solve(B.transpose());
    H.diagonal().head(kDense) += damping * (H.topLeftCorner(kDense, kDense) - less).diagonal();
  }

  std::vector<std::byte> memory;
  Arena arena;
  test::Shot shot;
  std::vector<CameraView> views;
  JointProblem problem;
  NormalEquations equations;
  double cost = 0;
};

TEST(LensTerms, Layout_HasABlockForEveryRefinedCameraOnly) {
  const Fixture f;
  ASSERT_EQ(f.problem.lenses.size(), 2U);
  EXPECT_EQ(f.problem.lenses[1].view, 2U);
  EXPECT_EQ(f.problem.views[1].lens, kHeldLens);
  EXPECT_EQ(f.equations.size, static_cast<std::size_t>(kDense));
}

TEST(LensTerms, ReducedInformation_IsTheSchurComplementOfTheDenseOne) {
  Fixture f;
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  for (const double damping : {0.0, 0.3}) {
    f.dense(damping, H, g);
    f.equations.assemble(f.problem, damping);
    const Index rest = H.rows() - kDense;
    const Eigen::MatrixXd B = H.topRightCorner(kDense, rest);
    const Eigen::MatrixXd S =
        H.topLeftCorner(kDense, kDense) - B * H.bottomRightCorner(rest, rest).ldlt().solve(B.transpose());
    for (Index i = 0; i < kDense; ++i)
      for (Index j = 0; j <= i; ++j)
        EXPECT_NEAR(f.equations.S[static_cast<std::size_t>(kDense * i + j)], S(i, j),
                    1e-9 * std::sqrt(S(i, i) * S(j, j)))
            << i << " " << j;
  }
}

TEST(LensTerms, Step_SolvesTheDenseSystem) {
  Fixture f;
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  f.dense(0.3, H, g);
  const Eigen::VectorXd step = -H.ldlt().solve(g);
  double decrement = 0;
  f.equations.assemble(f.problem, 0.3);
  ASSERT_TRUE(f.equations.step(f.problem, decrement).ok());
  EXPECT_NEAR(decrement, -g.dot(step), 1e-9 * decrement);
  for (std::size_t k = 0; k < 2; ++k) {
    const camera::Parameters dv = f.problem.trial.v[k] - f.problem.state.v[k];
    EXPECT_LT((dv - step.segment<8>(kPoses + 8 * static_cast<Index>(k))).norm(), 1e-9 * step.norm());
    EXPECT_NE(camera::parameters_of(f.problem.trial.camera[k].intrinsics()),
              camera::parameters_of(f.problem.state.camera[k].intrinsics()));
  }
  for (std::size_t l = 0; l < f.problem.landmarks.size(); ++l) {
    if (f.problem.landmarks[l].exact || f.problem.landmarks[l].count == 0) continue;
    const Vec3 du = f.problem.trial.u[l] - f.problem.state.u[l];
    EXPECT_LT((du - step.segment<3>(kDense + 3 * static_cast<Index>(l))).norm(), 1e-9 * step.norm());
  }
}

TEST(LensTerms, Gradient_IsHalfTheDerivativeOfTheCost) {
  Fixture f;
  f.equations.assemble(f.problem, 0);
  EXPECT_NEAR(f.problem.cost(f.problem.state), f.cost, 1e-9 * f.cost);
  for (std::size_t k = 0; k < 2; ++k)
    for (Index i = 0; i < 8; ++i) {
      const auto cost_at = [&](double move) {
        std::copy(f.problem.state.T_room_sensor.begin(), f.problem.state.T_room_sensor.end(),
                  f.problem.trial.T_room_sensor.begin());
        std::copy(f.problem.state.u.begin(), f.problem.state.u.end(), f.problem.trial.u.begin());
        for (std::size_t other = 0; other < 2; ++other) {
          camera::Parameters v = f.problem.state.v[other];
          if (other == k) v[i] += move;
          f.move_to(other, v, f.problem.trial);
        }
        return f.problem.cost(f.problem.trial);
      };
      const double numeric = (cost_at(1e-4) - cost_at(-1e-4)) / 2e-4;
      const double analytic = 2 * f.equations.gradient[f.equations.lens_offset(k) + static_cast<std::size_t>(i)];
      EXPECT_NEAR(analytic, numeric, 1e-5 * (std::abs(numeric) + f.cost)) << k << " " << i;
    }
}

TEST(LensTerms, StepToNoLensAtAll_IsRefused) {
  Fixture f;
  f.equations.assemble(f.problem, 0);
  f.problem.lenses[0].sigma[0] = 1e12;
  f.problem.state.v[0][0] = -1;
  double decrement = 0;
  EXPECT_EQ(f.equations.step(f.problem, decrement).code(), StatusCode::kDegenerate);
}

}  // namespace
}  // namespace roomcal::rig
