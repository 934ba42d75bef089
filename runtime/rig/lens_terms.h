#pragma once

#include <cstdint>
#include <span>

#include "runtime/rig/joint_problem.h"
#include "runtime/rig/normal_equations.h"

namespace roomcal::rig {

// The part that refined intrinsics have in the normal equations: a block of eight for every lens, after all poses.

/// Their own information and gradient, prior included, and what ties them to their camera's pose.
void add_lenses(const JointProblem& problem, NormalEquations& equations);

/// What eliminating one landmark takes off: between lenses, and between lenses and the poses of all cameras that see
/// it.
void eliminate_from_lenses(const JointProblem& problem, std::span<const uint32_t> group, const LandmarkTerms& landmark,
                           NormalEquations& equations);

/// Writes state + step to the trial's lenses.
/// @param[out] decrement  their part, -g^T step, is added.
/// @return kDegenerate if the step leads to no lens at all (one that folds, a focal length that is not positive).
Status step_lenses(const NormalEquations& equations, JointProblem& problem, double& decrement);

}  // namespace roomcal::rig
