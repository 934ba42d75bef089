#include "runtime/rig/normal_equations.h"

#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/runtime/rig/shot.h"

namespace roomcal::rig {
namespace {

using Index = Eigen::Index;

// A small problem with shared, uncertain landmarks, away from its minimum, linearized.
struct Fixture {
  Fixture() : memory(4U << 20U), arena(memory) {
    truth::Random random(31);
    const auto room = truth::make_room(random, 60);
    test::ShotOptions options;
    options.cameras = 3;
    options.lens = truth::LensKind::kFisheye;
    options.map_cov_m2 = Vec3(4e-6, 25e-6, 1e-6).asDiagonal();
    options.outlier_fraction = 0.1;
    options.start_sigma_m = options.start_sigma_rad = 1e-4;
    shot = test::make_shot(random, room, options);
    shot.landmarks[3].cov_m2.setZero();  // exact ones among the others
    shot.landmarks[8].cov_m2.setZero();
    EXPECT_TRUE(JointProblem::build({shot.views(), {}, kNoReference, shot.landmarks}, {}, arena, problem).ok());
    EXPECT_TRUE(NormalEquations::build(3, 0, arena, equations).ok());
    for (Vec3& u : problem.state.u) u = 0.1 * random.normals<3>();
    problem.linearize();
    problem.update_turn_over();
    cost = problem.reweight();
  }

  // The whole information and gradient, nothing eliminated: poses first, then three unknowns for every landmark.
  void dense(double damping, Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
    const Index poses = 18, all = poses + 3 * static_cast<Index>(problem.landmarks.size());
    H = Eigen::MatrixXd::Zero(all, all);
    g = Eigen::VectorXd::Zero(all);
    H.diagonal().tail(all - poses).setOnes();
    for (std::size_t l = 0; l < problem.landmarks.size(); ++l)
      if (!problem.landmarks[l].exact) g.segment<3>(poses + 3 * static_cast<Index>(l)) = problem.state.u[l];
    for (const Term& term : problem.terms) {
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2, all);
      J.middleCols<6>(6 * term.view) = term.J_pose;
      if (!problem.landmarks[term.landmark].exact) J.middleCols<3>(poses + 3 * term.landmark) = term.J_u;
      H += term.weight * J.transpose() * J;
      g += term.weight * J.transpose() * term.r;
    }
    // The reduced system is damped, S = A - B C^-1 B^T: as much is added to A.
    const Index rest = all - poses;
    const Eigen::MatrixXd B = H.topRightCorner(poses, rest);
    const Eigen::MatrixXd less = B * H.bottomRightCorner(rest, rest).ldlt().solve(B.transpose());
    H.diagonal().head(poses) += damping * (H.topLeftCorner(poses, poses) - less).diagonal();
  }

  std::vector<std::byte> memory;
  Arena arena;
  test::Shot shot;
  JointProblem problem;
  NormalEquations equations;
  double cost = 0;
};

TEST(NormalEquations, ReducedInformation_IsTheSchurComplementOfTheDenseOne) {
  Fixture f;
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  for (const double damping : {0.0, 0.3}) {
    f.dense(damping, H, g);
    f.equations.assemble(f.problem, damping);
    const Index rest = H.rows() - 18;
    const Eigen::MatrixXd B = H.topRightCorner(18, rest);
    const Eigen::MatrixXd S = H.topLeftCorner(18, 18) - B * H.bottomRightCorner(rest, rest).ldlt().solve(B.transpose());
    for (Index i = 0; i < 18; ++i)
      for (Index j = 0; j <= i; ++j)
        EXPECT_NEAR(f.equations.S[static_cast<std::size_t>(18 * i + j)], S(i, j), 1e-9 * S.norm()) << i << " " << j;
  }
}

TEST(NormalEquations, Step_SolvesTheDenseSystem) {
  Fixture f;
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  for (const double damping : {0.0, 0.3}) {
    f.dense(damping, H, g);
    const Eigen::VectorXd step = -H.ldlt().solve(g);
    double decrement = 0;
    f.equations.assemble(f.problem, damping);
    ASSERT_TRUE(f.equations.step(f.problem, decrement).ok());
    EXPECT_NEAR(decrement, -g.dot(step), 1e-9 * decrement);
    for (std::size_t v = 0; v < 3; ++v) {
      const Vec6 xi = se3_log(f.problem.state.T_room_sensor[v].inverse() * f.problem.trial.T_room_sensor[v]);
      EXPECT_LT((xi - step.segment<6>(6 * static_cast<Index>(v))).norm(), 1e-11);
    }
    for (std::size_t l = 0; l < f.problem.landmarks.size(); ++l) {
      if (f.problem.landmarks[l].exact || f.problem.landmarks[l].count == 0) continue;
      const Vec3 du = f.problem.trial.u[l] - f.problem.state.u[l];
      EXPECT_LT((du - step.segment<3>(18 + 3 * static_cast<Index>(l))).norm(), 1e-9 * step.norm());
    }
  }
}

TEST(NormalEquations, Gradient_IsHalfTheDerivativeOfTheCost) {
  Fixture f;
  f.equations.assemble(f.problem, 0);
  EXPECT_NEAR(f.problem.cost(f.problem.state), f.cost, 1e-9 * f.cost);
  for (std::size_t k = 0; k < 18; ++k) {
    const auto cost_at = [&](double move) {
      Vec6 xi = Vec6::Zero();
      xi[static_cast<Index>(k % 6)] = move;
      for (std::size_t v = 0; v < 3; ++v)
        f.problem.trial.T_room_sensor[v] = f.problem.state.T_room_sensor[v] * se3_exp(v == k / 6 ? xi : Vec6::Zero());
      for (std::size_t l = 0; l < f.problem.landmarks.size(); ++l) f.problem.trial.u[l] = f.problem.state.u[l];
      return f.problem.cost(f.problem.trial);
    };
    const double numeric = (cost_at(1e-7) - cost_at(-1e-7)) / 2e-7;
    EXPECT_NEAR(2 * f.equations.gradient[k], numeric, 1e-4 * (std::abs(numeric) + f.cost)) << k;
  }
}

}  // namespace
}  // namespace roomcal::rig
