#include "runtime/rig/lens_terms.h"

namespace roomcal::rig {

namespace {

constexpr int kSize = camera::kIntrinsicsCount;
using Part = Eigen::Map<camera::Parameters>;
using ConstPart = Eigen::Map<const camera::Parameters>;

template <int Cols>
using Block = Eigen::Map<Eigen::Matrix<double, kSize, Cols, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;

/// Rows of a lens, columns of a pose (6) or of a lens (8).
template <int Cols>
Block<Cols> block(NormalEquations& equations, std::size_t lens, std::size_t first_column) {
  return Block<Cols>(&equations.S[equations.lens_offset(lens) * equations.size + first_column],
                     Eigen::OuterStride<>(static_cast<Eigen::Index>(equations.size)));
}

}  // namespace

void add_lenses(const JointProblem& problem, NormalEquations& equations) {
  for (std::size_t k = 0; k < problem.lenses.size(); ++k) {
    const ViewTerms& view = problem.views[problem.lenses[k].view];
    auto own = block<kSize>(equations, k, equations.lens_offset(k));
    auto with_pose = block<6>(equations, k, 6 * problem.lenses[k].view);
    Part gradient(&equations.gradient[equations.lens_offset(k)]);
    own += camera::ParameterMatrix::Identity();
    gradient += problem.state.v[k];
    for (std::size_t i = view.first; i < view.first + view.count; ++i) {
      const Term& term = problem.terms[i];
      if (term.weight == 0) continue;
      const Eigen::Matrix<double, kSize, 2> Jt = term.weight * problem.J_lens[i].transpose();
      own += Jt * problem.J_lens[i];
      with_pose += Jt * term.J_pose;
      gradient += Jt * term.r;
    }
  }
}

void eliminate_from_lenses(const JointProblem& problem, std::span<const uint32_t> group, const LandmarkTerms& landmark,
                           NormalEquations& equations) {
  const Vec3 C_inv_g = landmark.C_inv * landmark.g;
  for (const uint32_t i : group) {
    const Term& a = problem.terms[i];
    const std::size_t lens_a = problem.views[a.view].lens;
    if (a.weight == 0 || lens_a == kHeldLens) continue;
    const Mat23 left = a.weight * a.J_u * landmark.C_inv;
    const Eigen::Matrix<double, kSize, 2> Jt = problem.J_lens[i].transpose();
    Part(&equations.dx[equations.lens_offset(lens_a)]) += Jt * (a.weight * (a.J_u * C_inv_g));
    for (const uint32_t j : group) {
      const Term& b = problem.terms[j];
      if (b.weight == 0) continue;
      const std::size_t lens_b = problem.views[b.view].lens;
      const Mat22 K = left * b.J_u.transpose() * b.weight;
      const Eigen::Matrix<double, kSize, 2> Jt_K = Jt * K;
      block<6>(equations, lens_a, 6 * b.view) -= Jt_K * b.J_pose;
      if (lens_b != kHeldLens && lens_b <= lens_a)  // the lower blocks suffice
        block<kSize>(equations, lens_a, equations.lens_offset(lens_b)) -= Jt_K * problem.J_lens[j];
    }
  }
}

Status step_lenses(const NormalEquations& equations, JointProblem& problem, double& decrement) {
  for (std::size_t k = 0; k < problem.lenses.size(); ++k) {
    const ConstPart dv(&equations.dx[equations.lens_offset(k)]);
    decrement -= ConstPart(&equations.gradient[equations.lens_offset(k)]).dot(dv);
    problem.trial.v[k] = problem.state.v[k] + dv;
    const LensTerms& lens = problem.lenses[k];
    const camera::Intrinsics& prior = problem.views[lens.view].camera->intrinsics();
    const camera::Parameters moved = camera::parameters_of(prior) + lens.sigma.cwiseProduct(problem.trial.v[k]);
    const Result<camera::Camera> made = camera::Camera::create(camera::with_parameters(prior, moved));
    if (!made.ok()) return {StatusCode::kDegenerate, "the step leads to intrinsics that no lens has"};
    problem.trial.camera[k] = made.value();
  }
  return ok_status();
}

}  // namespace roomcal::rig
