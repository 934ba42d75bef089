#pragma once

#include "runtime/rig/joint_problem.h"
#include "runtime/rig/normal_equations.h"

namespace roomcal::rig {

/// The LiDARs' part of the cost at a state: the quadratic of each one's points, the width of open directions, its
/// mount. Up to a constant; may be negative.
double lidar_cost(const JointProblem& problem, const State& at);

/// The same in the normal equations at problem.state, relinearized there: blocks of the LiDARs, and of the reference
/// camera where a mount ties them.
void add_lidars(const JointProblem& problem, NormalEquations& equations);

}  // namespace roomcal::rig
