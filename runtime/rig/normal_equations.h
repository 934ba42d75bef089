#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/rig/joint_problem.h"

namespace roomcal::rig {

/// The normal equations of a linearized JointProblem with the map points eliminated. With the 6n poses x and points u,
///     [A   B] [dx]     [g_x]
///     [B^T C] [du] = - [g_u],   S = A - B C^-1 B^T,   S dx = -(g_x - B C^-1 g_u),   du = -C^-1 (g_u + B^T dx).
/// S (6n x 6n, row-major) is the information of all poses together with the points' uncertainty in it.
struct NormalEquations {
  std::span<double> S;         ///< lower blocks filled by assemble()
  std::span<double> dx;        ///< right-hand side, then the step
  std::span<double> gradient;  ///< g_x, not reduced
  std::size_t size = 0;        ///< 6 x sensors

  static Status build(std::size_t sensors, Arena& scratch, NormalEquations& equations);
  static std::size_t bytes(std::size_t sensors);

  /// Fills S and dx's right-hand side; damping multiplies the diagonals of A and C by (1 + damping).
  /// Cost: linear in observations, quadratic in how many of them share one landmark.
  void assemble(JointProblem& problem, double damping);

  /// Solves, and writes state + step to problem.trial. assemble() comes first; S is spoilt.
  /// @param[out] decrement  -g^T step: twice the decrease of half the cost that an undamped step promises.
  /// @return kDegenerate if S is not positive definite; the trial is then not set.
  Status step(JointProblem& problem, double& decrement);
};

}  // namespace roomcal::rig
