#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/rig/joint_problem.h"

namespace roomcal::rig {

/// The normal equations of a linearized JointProblem with the map points eliminated. With x the 6n of the poses and the
/// 8 of every refined lens, and points u,
///     [A   B] [dx]     [g_x]
///     [B^T C] [du] = - [g_u],   S = A - B C^-1 B^T,   S dx = -(g_x - B C^-1 g_u),   du = -C^-1 (g_u + B^T dx).
/// S (row-major) is the information of x with the points' uncertainty in it.
struct NormalEquations {
  std::span<double> S;         ///< lower blocks filled by assemble()
  std::span<double> dx;        ///< right-hand side, then the step
  std::span<double> gradient;  ///< g_x, not reduced
  std::size_t sensors = 0;
  std::size_t size = 0;  ///< 6 x sensors + 8 x lenses

  static Status build(std::size_t sensors, std::size_t lenses, Arena& scratch, NormalEquations& equations);
  static std::size_t bytes(std::size_t sensors, std::size_t lenses);

  /// Where the block of a refined lens begins.
  std::size_t lens_offset(std::size_t lens) const { return 6 * sensors + camera::kIntrinsicsCount * lens; }

  /// Fills S and dx's right-hand side; damping multiplies the diagonal of S by (1 + damping). Not that of A: with rings
  /// far better than the map, S is a millionth of A, and the least damping of A would be all that S has.
  /// Cost: linear in observations, quadratic in how many of them share one landmark.
  void assemble(JointProblem& problem, double damping);

  /// Solves, and writes state + step to problem.trial. assemble() comes first; S is spoilt.
  /// @param[out] decrement  -g^T step: twice the decrease of half the cost that an undamped step promises.
  /// @return kDegenerate if S is not positive definite, or the step leads to no lens; the trial is then not to be used.
  Status step(JointProblem& problem, double& decrement);
};

}  // namespace roomcal::rig
