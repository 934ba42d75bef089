#include "runtime/rig/normal_equations.h"

#include <algorithm>

#include <Eigen/LU>

#include "runtime/math/dense_ldlt.h"
#include "runtime/rig/lens_terms.h"
#include "runtime/rig/lidar_terms.h"

namespace roomcal::rig {

namespace {

using Block = Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;
using Part = Eigen::Map<Vec6>;

Block block(std::span<double> S, std::size_t size, std::size_t row_view, std::size_t col_view) {
  return Block(&S[6 * row_view * size + 6 * col_view], Eigen::OuterStride<>(static_cast<Eigen::Index>(size)));
}

Part part(std::span<double> v, std::size_t view) { return Part(&v[6 * view]); }

Eigen::Map<const camera::Parameters> lens_part(std::span<const double> v, std::size_t offset) {
  return Eigen::Map<const camera::Parameters>(&v[offset]);
}

// A and g_x: every observation on its own.
void add_poses(const JointProblem& problem, NormalEquations& equations) {
  for (const Term& term : problem.terms) {
    if (term.weight == 0) continue;
    const Eigen::Matrix<double, 6, 2> Jt = term.weight * term.J_pose.transpose();
    block(equations.S, equations.size, term.view, term.view) += Jt * term.J_pose;
    part(equations.gradient, term.view) += Jt * term.r;
  }
}

// C^-1 and g_u of one landmark; the prior's information in u is the identity.
void form_landmark(const JointProblem& problem, std::span<const uint32_t> group, const Vec3& u,
                   LandmarkTerms& landmark) {
  Mat33 C = Mat33::Identity();
  landmark.g = u;
  for (const uint32_t i : group) {
    const Term& term = problem.terms[i];
    const Mat32 Jt = term.weight * term.J_u.transpose();
    C += Jt * term.J_u;
    landmark.g += Jt * term.r;
  }
  landmark.C_inv = C.inverse();
}

// -B C^-1 B^T and -B C^-1 g_u of one landmark. B's blocks are J_pose^T w J_u, so each pair of observations meets in a
// 2x2 matrix and no block of B is ever stored.
void eliminate(const JointProblem& problem, std::span<const uint32_t> group, const LandmarkTerms& landmark,
               NormalEquations& equations) {
  const Vec3 C_inv_g = landmark.C_inv * landmark.g;
  for (const uint32_t i : group) {
    const Term& a = problem.terms[i];
    if (a.weight == 0) continue;
    const Mat23 left = a.weight * a.J_u * landmark.C_inv;
    part(equations.dx, a.view) += a.J_pose.transpose() * (a.weight * (a.J_u * C_inv_g));
    for (const uint32_t j : group) {
      const Term& b = problem.terms[j];
      if (b.weight == 0 || b.view > a.view) continue;  // the lower blocks suffice
      const Mat22 K = left * b.J_u.transpose() * b.weight;
      const Eigen::Matrix<double, 6, 2> Jt_K = a.J_pose.transpose() * K;
      block(equations.S, equations.size, a.view, b.view) -= Jt_K * b.J_pose;
    }
  }
}

}  // namespace

Status NormalEquations::build(std::size_t sensors, std::size_t lenses, Arena& scratch, NormalEquations& equations) {
  equations.sensors = sensors;
  equations.size = equations.lens_offset(lenses);
  equations.S = scratch.allocate<double>(equations.size * equations.size);
  equations.dx = scratch.allocate<double>(equations.size);
  equations.gradient = scratch.allocate<double>(equations.size);
  if (equations.S.empty() || equations.dx.empty() || equations.gradient.empty())
    return out_of_arena("scratch arena: no room for the normal equations: reserve solve_scratch_bytes()");
  return ok_status();
}

std::size_t NormalEquations::bytes(std::size_t sensors, std::size_t lenses) {
  const std::size_t size = 6 * sensors + camera::kIntrinsicsCount * lenses;
  return (size * size + 2 * size) * sizeof(double) + 3 * alignof(double);
}

void NormalEquations::assemble(JointProblem& problem, double damping) {
  std::fill(S.begin(), S.end(), 0.0);
  std::fill(gradient.begin(), gradient.end(), 0.0);
  add_poses(problem, *this);
  add_lenses(problem, *this);
  add_lidars(problem, *this);
  for (std::size_t i = 0; i < size; ++i) dx[i] = -gradient[i];
  for (std::size_t l = 0; l < problem.landmarks.size(); ++l) {
    LandmarkTerms& landmark = problem.landmarks[l];
    if (landmark.exact || landmark.count == 0) continue;
    const auto group = problem.by_landmark.subspan(landmark.first, landmark.count);
    form_landmark(problem, group, problem.state.u[l], landmark);
    eliminate(problem, group, landmark, *this);
    if (!problem.lenses.empty()) eliminate_from_lenses(problem, group, landmark, *this);
  }
  for (std::size_t i = 0; i < size; ++i) S[i * size + i] *= 1 + damping;
}

Status NormalEquations::step(JointProblem& problem, double& decrement) {
  ROOMCAL_TRY(ldlt_factor(S, size));
  ldlt_solve(S, size, dx);
  decrement = 0;
  for (std::size_t i = 0; i < problem.state.T_room_sensor.size(); ++i) {
    decrement -= part(gradient, i).dot(part(dx, i));
    problem.trial.T_room_sensor[i] = problem.state.T_room_sensor[i] * se3_exp(part(dx, i));
  }
  ROOMCAL_TRY(step_lenses(*this, problem, decrement));
  for (std::size_t l = 0; l < problem.landmarks.size(); ++l) {
    const LandmarkTerms& landmark = problem.landmarks[l];
    if (landmark.exact || landmark.count == 0) continue;
    Vec3 rhs = landmark.g;
    for (const uint32_t i : problem.by_landmark.subspan(landmark.first, landmark.count)) {
      const Term& term = problem.terms[i];
      if (term.weight == 0) continue;
      rhs += term.J_u.transpose() * (term.weight * (term.J_pose * part(dx, term.view)));
      if (const std::size_t lens = problem.views[term.view].lens; lens != kHeldLens)
        rhs += term.J_u.transpose() * (term.weight * (problem.J_lens[i] * lens_part(dx, lens_offset(lens))));
    }
    const Vec3 du = -(landmark.C_inv * rhs);
    decrement -= landmark.g.dot(du);
    problem.trial.u[l] = problem.state.u[l] + du;
  }
  return ok_status();
}

}  // namespace roomcal::rig
