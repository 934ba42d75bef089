#include "runtime/rig/levenberg_marquardt.h"

#include <algorithm>
#include <cmath>

namespace roomcal::rig {

namespace {

// The locator's poses are a Gauss-Newton step from the answer: hardly any damping to begin with.
constexpr double kFirstDamping = 1e-6, kLeastDamping = 1e-9, kMostDamping = 1e12;
// The decrement is the squared length of the step in sigmas; the relative part is the rounding of large costs.
constexpr double kConverged = 1e-10, kConvergedRelative = 1e-12;
// A step of less than 0.001 sigma that does not lower the cost: pixels are rounded to 1e-13, the cost therefore to
// 1e-11.
constexpr double kRounding = 1e-6;
constexpr double kStillMoving = 1e-2;  // sigma^2; the turn-over follows the residuals as long as steps are this large
constexpr double kGoodEnough = 1e-4;   // sigma^2, when the rounds are used up
// A step that damping has shortened proves nothing about convergence.
constexpr double kUndamped = 1e-3;

void accept_trial(JointProblem& problem) {
  std::copy(problem.trial.T_room_sensor.begin(), problem.trial.T_room_sensor.end(),
            problem.state.T_room_sensor.begin());
  std::copy(problem.trial.u.begin(), problem.trial.u.end(), problem.state.u.begin());
  std::copy(problem.trial.v.begin(), problem.trial.v.end(), problem.state.v.begin());
  std::copy(problem.trial.camera.begin(), problem.trial.camera.end(), problem.state.camera.begin());
}

}  // namespace

Status minimize(JointProblem& problem, NormalEquations& equations, int max_iterations, MinimizeReport& report) {
  problem.linearize();
  problem.update_turn_over();
  double cost = problem.reweight();
  double damping = kFirstDamping, last_decrement = 1e300;
  for (report.iterations = 1; report.iterations <= max_iterations; ++report.iterations) {
    double decrement = 0;
    equations.assemble(problem, damping);
    const bool solved = equations.step(problem, decrement).ok();
    const bool tiny = solved && damping <= kUndamped && decrement <= kConverged + kConvergedRelative * std::abs(cost);
    if (!tiny && !(solved && problem.cost(problem.trial) < cost)) {
      if (solved && damping <= kUndamped && decrement <= kRounding) {
        report.stop = StopReason::kConverged;
        return ok_status();
      }
      damping *= 10;
      if (damping > kMostDamping) break;
      continue;
    }
    accept_trial(problem);
    damping = std::max(kLeastDamping, damping * 0.1);
    problem.linearize();
    if (decrement > kStillMoving) problem.update_turn_over();
    cost = problem.reweight();
    last_decrement = decrement;
    if (!tiny) continue;
    report.stop = StopReason::kConverged;
    return ok_status();
  }
  report.iterations = std::min(report.iterations, max_iterations);
  if (damping <= kUndamped && last_decrement <= kGoodEnough) return ok_status();
  return {StatusCode::kNotConverged, "joint fit did not settle: check the map, the intrinsics and the inliers"};
}

}  // namespace roomcal::rig
