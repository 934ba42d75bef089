#include "runtime/rig/camera_rig.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "runtime/rig/covariance.h"
#include "runtime/rig/input_check.h"
#include "runtime/rig/levenberg_marquardt.h"
#include "runtime/rig/plane_terms.h"

namespace roomcal::rig {

namespace {

std::size_t unknowns(std::size_t sensors, std::size_t lenses) {
  return 6 * sensors + camera::kIntrinsicsCount * lenses;
}

Status allocate_solution(std::size_t sensors, std::size_t lenses, Arena& step, RigSolution& solution) {
  const std::size_t size = unknowns(sensors, lenses);
  solution.T_room_sensor = step.allocate<SE3>(sensors);
  solution.cov_room = step.allocate<double>(size * size);
  solution.lenses = step.allocate<RefinedLens>(lenses);
  solution.rms_px = step.allocate<double>(sensors);
  solution.outliers = step.allocate<uint16_t>(sensors);
  solution.chi2_camera = step.allocate<double>(sensors);
  if (solution.T_room_sensor.empty() || solution.cov_room.empty() || solution.rms_px.empty() ||
      solution.outliers.empty() || solution.chi2_camera.empty() || solution.lenses.size() != lenses)
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
  solution.chi2 += problem.lens_cost(problem.state);
  solution.degrees_of_freedom = 2 * inliers - 6 * static_cast<int>(problem.views.size());
}

/// Takes the covariance over, from whitened to true parameters.
void fill_covariance(const JointProblem& problem, std::span<const double> cov, RigSolution& solution) {
  const std::size_t poses = 6 * solution.T_room_sensor.size();
  const std::size_t size = unknowns(solution.T_room_sensor.size(), problem.lenses.size());
  const auto unit = [&](std::size_t i) {
    if (i < poses) return 1.0;
    const std::size_t k = i - poses;
    return problem.lenses[k / camera::kIntrinsicsCount].sigma[static_cast<Eigen::Index>(k % camera::kIntrinsicsCount)];
  };
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j) solution.cov_room[i * size + j] = unit(i) * cov[i * size + j] * unit(j);
}

void fill_lenses(const JointProblem& problem, RigSolution& solution) {
  for (std::size_t k = 0; k < problem.lenses.size(); ++k) {
    RefinedLens& lens = solution.lenses[k];
    lens.view = problem.lenses[k].view;
    lens.camera = problem.state.camera[k];
    lens.prior = camera::parameters_of(problem.views[lens.view].camera->intrinsics());
    lens.prior_sigma = problem.lenses[k].sigma;
    lens.sigma = solution.cov_lens(k).diagonal().cwiseMax(0).cwiseSqrt();
  }
}

/// Rows x Cols of the covariance from (row, col) on.
template <int Rows, int Cols>
Eigen::Matrix<double, Rows, Cols> part_of(const RigSolution& solution, std::size_t row, std::size_t col) {
  const std::size_t size = unknowns(solution.T_room_sensor.size(), solution.lenses.size());
  Eigen::Matrix<double, Rows, Cols> part;
  for (Eigen::Index r = 0; r < Rows; ++r)
    for (Eigen::Index c = 0; c < Cols; ++c)
      part(r, c) = solution.cov_room[(row + static_cast<std::size_t>(r)) * size + col + static_cast<std::size_t>(c)];
  return part;
}

}  // namespace

Mat66 RigSolution::cov_block(std::size_t i, std::size_t j) const {
  assert(i < T_room_sensor.size() && j < T_room_sensor.size());
  return part_of<6, 6>(*this, 6 * i, 6 * j);
}

camera::ParameterMatrix RigSolution::cov_lens(std::size_t lens) const {
  assert(lens < lenses.size());
  const std::size_t at = unknowns(T_room_sensor.size(), lens);
  return part_of<camera::kIntrinsicsCount, camera::kIntrinsicsCount>(*this, at, at);
}

Eigen::Matrix<double, 6, camera::kIntrinsicsCount> RigSolution::cov_pose_lens(std::size_t sensor,
                                                                              std::size_t lens) const {
  assert(sensor < T_room_sensor.size() && lens < lenses.size());
  return part_of<6, camera::kIntrinsicsCount>(*this, 6 * sensor, unknowns(T_room_sensor.size(), lens));
}

const RefinedLens* RigSolution::lens_of(std::size_t view) const {
  const auto found = std::find_if(lenses.begin(), lenses.end(), [&](const RefinedLens& l) { return l.view == view; });
  return found == lenses.end() ? nullptr : &*found;
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

std::size_t solve_scratch_bytes(std::size_t sensors, std::size_t observations, std::size_t landmarks,
                                std::size_t lenses, std::size_t lidars) {
  const std::size_t size = unknowns(sensors, lenses);
  return JointProblem::bytes(sensors, observations, landmarks, lenses) + NormalEquations::bytes(sensors, lenses) +
         size * size * sizeof(double) + (lidars == 0 ? 0 : LidarsOnPlanes::bytes(lidars) + correlation_bytes(size));
}

std::size_t solve_step_bytes(std::size_t sensors, std::size_t lenses) {
  const std::size_t size = unknowns(sensors, lenses);
  return sensors * (sizeof(SE3) + 2 * sizeof(double) + sizeof(uint16_t)) + size * size * sizeof(double) +
         lenses * sizeof(RefinedLens) + alignof(RefinedLens) + 5 * alignof(double);
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
  const std::size_t lenses = problem.lenses.size();
  ROOMCAL_TRY(NormalEquations::build(sensors, lenses, scratch, equations));
  const std::span<double> cov = scratch.allocate<double>(equations.size * equations.size);
  if (cov.empty()) return out_of_arena("scratch arena: no room for the covariance: reserve solve_scratch_bytes()");

  MinimizeReport report;
  const Status fit = minimize(problem, equations, options.max_iterations, report);
  // A camera that is not determined also keeps the fit from settling, and is the better thing to say.
  equations.assemble(problem, 0);
  std::size_t blamed = 0;
  const Status seen =
      invert_information(equations.S, sensors, cov, blamed, input.lidars.size(), equations.size - 6 * sensors);
  if (!seen.ok()) {
    if (degenerate_view != nullptr) *degenerate_view = blamed;
    return seen;
  }
  ROOMCAL_TRY(fit);
  ROOMCAL_TRY(correlate_planes_with_markers(problem, equations, scratch, cov));

  RigSolution filled;
  ROOMCAL_TRY(allocate_solution(sensors, lenses, step, filled));
  std::copy(problem.state.T_room_sensor.begin(), problem.state.T_room_sensor.end(), filled.T_room_sensor.begin());
  fill_covariance(problem, cov, filled);
  fill_lenses(problem, filled);
  fill_residuals(problem, filled);
  filled.iterations = report.iterations;
  filled.stop = report.stop;
  solution = filled;
  return ok_status();
}

}  // namespace roomcal::rig
