#pragma once

#include <cstddef>

#include "runtime/math/se3.h"
#include "runtime/rig/joint_problem.h"
#include "runtime/rig/lidar_terms.h"

namespace roomcal::rig::test {

/// Central difference of the LiDARs' cost at problem.state along unknown k (six to a sensor); overwrites problem.trial.
inline double lidar_cost_derivative(JointProblem& problem, std::size_t sensors, std::size_t k) {
  const auto cost_at = [&](double move) {
    Vec6 xi = Vec6::Zero();
    xi[static_cast<Eigen::Index>(k % 6)] = move;
    for (std::size_t s = 0; s < sensors; ++s)
      problem.trial.T_room_sensor[s] = problem.state.T_room_sensor[s] * se3_exp(s == k / 6 ? xi : Vec6::Zero());
    return lidar_cost(problem, problem.trial);
  };
  return (cost_at(1e-6) - cost_at(-1e-6)) / 2e-6;
}

}  // namespace roomcal::rig::test
