#include "runtime/rig/camera_rig.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "runtime/rig/covariance.h"
#include "runtime/rig/input_check.h"
#include "runtime/rig/levenberg_marquardt.h"

namespace roomcal::rig {

namespace {

Status allocate_solution(std::size_t sensors, Arena& step, RigSolution& solution) {
  solution.T_room_sensor = step.allocate<SE3>(sensors);
  solution.cov_room = step.allocate<double>(36 * sensors * sensors);
  solution.rms_px = step.allocate<double>(sensors);
  solution.outliers = step.allocate<uint16_t>(sensors);
  solution.chi2_camera = step.allocate<double>(sensors);
  if (solution.T_room_sensor.empty() || solution.cov_room.empty() || solution.rms_px.empty() ||
      solution.outliers.empty() || solution.chi2_camera.empty())
    return out_of_arena("step arena: no room for the joint solution: reserve solve_step_bytes()");
  return ok_status();
}

// Residual statistics of the linearized problem.
void fill_residuals(const JointProblem& problem, RigSolution& solution) {
  int inliers = 0;
  for (std::size_t v = 0; v < problem.views.size(); ++v) {
    const ViewTerms& view = problem.views[v];
    double sum_px2 = 0;
    std::size_t seen = 0;
    for (const Term& term : problem.terms.subspan(view.first, view.count)) {
      if (term.visible) {
        // W is lower triangular, so the residual in pixels comes back by forward substitution.
        const double x_px = term.r.x() / term.W(0, 0);
        const double y_px = (term.r.y() - term.W(1, 0) * x_px) / term.W(1, 1);
        sum_px2 += x_px * x_px + y_px * y_px;
        ++seen;
      }
      if (term.weight < RedescendingLoss::kOutlierWeight) {
        ++solution.outliers[v];
        continue;
      }
      solution.chi2 += term.r.squaredNorm();
      solution.chi2_camera[v] += term.r.squaredNorm();
      ++inliers;
    }
    solution.rms_px[v] = seen == 0 ? 0 : std::sqrt(sum_px2 / static_cast<double>(seen));
  }
  for (std::size_t l = 0; l < problem.landmarks.size(); ++l)
    if (!problem.landmarks[l].exact) solution.chi2 += problem.state.u[l].squaredNorm();
  solution.degrees_of_freedom = 2 * inliers - 6 * static_cast<int>(problem.views.size());
}

}  // namespace

Mat66 RigSolution::cov_block(std::size_t i, std::size_t j) const {
  assert(i < T_room_sensor.size() && j < T_room_sensor.size());
  const std::size_t size = 6 * T_room_sensor.size();
  Mat66 block;
  for (std::size_t row = 0; row < 6; ++row)
    for (std::size_t col = 0; col < 6; ++col)
      block(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(col)) =
          cov_room[(6 * i + row) * size + 6 * j + col];
  return block;
}

RelativePose relative_pose(const RigSolution& solution, std::size_t a, std::size_t b) {
  RelativePose relative;
  relative.T_a_b = solution.T_room_sensor[a].inverse() * solution.T_room_sensor[b];
  // (T_room_a exp(xi_a))^-1 T_room_b exp(xi_b) = exp(-xi_a) T_a_b exp(xi_b) = T_a_b exp(xi_b - Ad(T_b_a) xi_a).
  const Mat66 Ad = se3_adjoint(relative.T_a_b.inverse());
  const Mat66 cross = Ad * solution.cov_block(a, b);
  relative.cov = solution.cov_block(b, b) + Ad * solution.cov_block(a, a) * Ad.transpose() - cross - cross.transpose();
  return relative;
}

std::size_t solve_scratch_bytes(std::size_t sensors, std::size_t observations, std::size_t landmarks) {
  return JointProblem::bytes(sensors, observations, landmarks) + NormalEquations::bytes(sensors) +
         36 * sensors * sensors * sizeof(double);
}

std::size_t solve_step_bytes(std::size_t sensors) {
  return sensors * (sizeof(SE3) + 2 * sizeof(double) + sizeof(uint16_t)) + 36 * sensors * sensors * sizeof(double) +
         5 * alignof(double);
}

Status solve_cameras(std::span<const CameraView> views, std::span<const Landmark> landmarks,
                     const SolveOptions& options, Arena& step, Arena& scratch, RigSolution& solution,
                     std::size_t* degenerate_view) {
  return solve_rig({views, {}, kNoReference, landmarks}, options, step, scratch, solution, degenerate_view);
}

Status solve_rig(const RigInput& input, const SolveOptions& options, Arena& step, Arena& scratch, RigSolution& solution,
                 std::size_t* degenerate_view) {
  ROOMCAL_TRY(check_inputs(input, options));
  const std::size_t sensors = input.cameras.size() + input.lidars.size();
  const Arena::Scope scope(scratch);
  JointProblem problem;
  NormalEquations equations;
  ROOMCAL_TRY(JointProblem::build(input, options, scratch, problem));
  ROOMCAL_TRY(NormalEquations::build(sensors, scratch, equations));
  const std::span<double> cov = scratch.allocate<double>(36 * sensors * sensors);
  if (cov.empty()) return out_of_arena("scratch arena: no room for the covariance: reserve solve_scratch_bytes()");

  MinimizeReport report;
  const Status fit = minimize(problem, equations, options.max_iterations, report);
  // A camera that is not determined also keeps the fit from settling, and is the better thing to say.
  equations.assemble(problem, 0);
  std::size_t blamed = 0;
  const Status seen = invert_information(equations.S, sensors, cov, blamed, input.lidars.size());
  if (!seen.ok()) {
    if (degenerate_view != nullptr) *degenerate_view = blamed;
    return seen;
  }
  ROOMCAL_TRY(fit);

  RigSolution filled;
  ROOMCAL_TRY(allocate_solution(sensors, step, filled));
  std::copy(problem.state.T_room_sensor.begin(), problem.state.T_room_sensor.end(), filled.T_room_sensor.begin());
  std::copy(cov.begin(), cov.end(), filled.cov_room.begin());
  fill_residuals(problem, filled);
  filled.iterations = report.iterations;
  filled.stop = report.stop;
  solution = filled;
  return ok_status();
}

}  // namespace roomcal::rig
