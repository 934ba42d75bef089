#pragma once

#include "runtime/rig/joint_problem.h"
#include "runtime/rig/normal_equations.h"

namespace roomcal::rig {

/// How the iteration ended.
struct MinimizeReport {
  int iterations = 0;
  StopReason stop = StopReason::kMaxIterations;
};

/// Brings problem.state to the minimum of the robust cost and leaves the problem linearized there.
/// Source: Marquardt 1963, damping of the diagonal; reweighted least squares for the loss.
/// @return kOk; kNotConverged when the rounds are used up with steps of more than 0.01 sigma, or nothing helps.
Status minimize(JointProblem& problem, NormalEquations& equations, int max_iterations, MinimizeReport& report);

}  // namespace roomcal::rig
