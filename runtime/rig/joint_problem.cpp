#include "runtime/rig/joint_problem.h"

#include <algorithm>
#include <cmath>

#include "runtime/rig/input_check.h"
#include "runtime/rig/lidar_terms.h"
#include "runtime/rig/reprojection.h"

namespace roomcal::rig {

namespace {

// Median of the squared length of a white 2-D residual: chi-square with two degrees of freedom, 2 ln 2.
constexpr double kMedianOfSquare = 1.3862943611198906;
// Wide enough for every start value; the first update brings it down.
constexpr double kWidestTurnOver = 1e6;

void lay_out_view(const CameraView& view, std::size_t number, double sigma_floor_px, JointProblem& problem,
                  uint32_t& next) {
  ViewTerms& terms = problem.views[number];
  terms.camera = view.camera;
  terms.first = next;
  terms.count = static_cast<uint32_t>(view.observations.size());
  terms.turn_over = kWidestTurnOver;
  problem.state.T_room_sensor[number] = view.T_room_cam;
  for (const RingObservation& observation : view.observations) {
    Term& term = problem.terms[next++];
    term.view = static_cast<uint16_t>(number);
    term.landmark = observation.landmark;
    term.centre_px = observation.centre_px;
    const Mat22 floor = sigma_floor_px * sigma_floor_px * Mat22::Identity();
    static_cast<void>(whitening(observation.cov_px2 + floor, term.W));  // checked by check_inputs()
    ++problem.landmarks[observation.landmark].count;
  }
}

bool is_refined(const CameraView& view) { return !view.intrinsics_sigma.isZero(0); }

/// What only a problem with refined intrinsics has. @return kOk or kOutOfMemory.
Status lay_out_lenses(std::span<const CameraView> views, Arena& scratch, JointProblem& problem) {
  const auto lenses = static_cast<std::size_t>(std::count_if(views.begin(), views.end(), is_refined));
  if (lenses == 0) return ok_status();
  problem.lenses = scratch.allocate<LensTerms>(lenses);
  problem.J_lens = scratch.allocate<Mat28>(problem.terms.size());
  for (State* state : {&problem.state, &problem.trial}) {
    state->v = scratch.allocate<camera::Parameters>(lenses);
    state->camera = scratch.allocate<camera::Camera>(lenses);
  }
  if (problem.lenses.empty() || problem.J_lens.size() != problem.terms.size() || problem.state.v.empty() ||
      problem.state.camera.empty() || problem.trial.v.empty() || problem.trial.camera.empty())
    return out_of_arena("scratch arena: no room for refined intrinsics: reserve solve_scratch_bytes()");
  std::size_t next = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!is_refined(views[i])) continue;
    problem.views[i].lens = next;
    problem.lenses[next] = {i, views[i].intrinsics_sigma};
    problem.state.v[next] = problem.trial.v[next] = camera::Parameters::Zero();
    problem.state.camera[next] = problem.trial.camera[next] = *views[i].camera;
    ++next;
  }
  return ok_status();
}

// Counting sort of the terms by landmark.
void group_by_landmark(JointProblem& problem) {
  uint32_t next = 0;
  for (LandmarkTerms& landmark : problem.landmarks) {
    landmark.first = next;
    next += landmark.count;
    landmark.count = 0;
  }
  for (std::size_t i = 0; i < problem.terms.size(); ++i) {
    LandmarkTerms& landmark = problem.landmarks[problem.terms[i].landmark];
    problem.by_landmark[landmark.first + landmark.count++] = static_cast<uint32_t>(i);
  }
}

}  // namespace

Status JointProblem::build(const RigInput& input, const SolveOptions& options, Arena& scratch, JointProblem& problem) {
  const std::span<const CameraView> views = input.cameras;
  const std::span<const Landmark> landmarks = input.landmarks;
  const std::size_t sensors = views.size() + input.lidars.size();
  std::size_t observations = 0;
  for (const CameraView& view : views) observations += view.observations.size();
  problem.terms = scratch.allocate<Term>(observations);
  problem.by_landmark = scratch.allocate<uint32_t>(observations);
  problem.sorted = scratch.allocate<double>(observations);
  problem.views = scratch.allocate<ViewTerms>(views.size());
  problem.landmarks = scratch.allocate<LandmarkTerms>(landmarks.size());
  problem.state = {scratch.allocate<SE3>(sensors), scratch.allocate<Vec3>(landmarks.size())};
  problem.trial = {scratch.allocate<SE3>(sensors), scratch.allocate<Vec3>(landmarks.size())};
  const bool refused = problem.terms.size() != observations || problem.by_landmark.size() != observations ||
                       problem.sorted.size() != observations || problem.views.size() != views.size() ||
                       problem.landmarks.size() != landmarks.size() || problem.state.T_room_sensor.empty() ||
                       problem.state.u.size() != landmarks.size() || problem.trial.T_room_sensor.empty() ||
                       problem.trial.u.size() != landmarks.size();
  if (refused) return out_of_arena("scratch arena: no room for the joint problem: reserve solve_scratch_bytes()");

  problem.robust_scale = options.robust_scale;
  problem.lidars = input.lidars;
  problem.given = landmarks;
  problem.plane_cov = input.plane_cov;
  ROOMCAL_TRY(LidarsOnPlanes::build(input, scratch, problem.planes));
  problem.reference = input.reference;
  for (std::size_t i = 0; i < input.lidars.size(); ++i)
    problem.state.T_room_sensor[views.size() + i] = input.lidars[i].points.T_hat;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    LandmarkTerms& landmark = problem.landmarks[i];
    landmark.prior_room = landmarks[i].p_room;
    static_cast<void>(covariance_root(landmarks[i].cov_m2, landmark.L));  // checked by check_inputs()
    landmark.exact = landmark.L.isZero(0);
    problem.state.u[i].setZero();
    problem.trial.u[i].setZero();
  }
  uint32_t next = 0;
  for (std::size_t i = 0; i < views.size(); ++i) lay_out_view(views[i], i, options.sigma_floor_px, problem, next);
  group_by_landmark(problem);
  return lay_out_lenses(views, scratch, problem);
}

std::size_t JointProblem::bytes(std::size_t sensors, std::size_t observations, std::size_t landmarks,
                                std::size_t lenses) {
  constexpr std::size_t kAlignmentSlack = 9 * alignof(std::max_align_t);
  const std::size_t refined =
      lenses == 0 ? 0
                  : lenses * (sizeof(LensTerms) + 2 * sizeof(camera::Parameters) + 2 * sizeof(camera::Camera)) +
                        observations * sizeof(Mat28) + 6 * alignof(camera::Parameters);
  return refined + observations * (sizeof(Term) + sizeof(uint32_t) + sizeof(double)) +
         sensors * (sizeof(ViewTerms) + 2 * sizeof(SE3)) + landmarks * (sizeof(LandmarkTerms) + 2 * sizeof(Vec3)) +
         kAlignmentSlack;
}

double JointProblem::cost(const State& at) const {
  double sum = 0;
  for (const Term& term : terms) {
    const ViewTerms& view = views[term.view];
    const RedescendingLoss loss(view.turn_over);
    Vec2 residual_px;
    const bool seen = reproject(camera(at, term.view), at.T_room_sensor[term.view], point_room(at, term.landmark),
                                term.centre_px, residual_px)
                          .ok();
    sum += seen ? loss((term.W * residual_px).squaredNorm()).loss : loss.max_loss();
  }
  for (std::size_t l = 0; l < landmarks.size(); ++l)
    if (!landmarks[l].exact) sum += at.u[l].squaredNorm();
  return sum + lens_cost(at) + lidar_cost(*this, at);
}

double JointProblem::lens_cost(const State& at) const {
  double sum = 0;
  for (const camera::Parameters& v : at.v) sum += v.squaredNorm();
  return sum;
}

void JointProblem::linearize() {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    Term& term = terms[i];
    const Vec3 p_room = point_room(state, term.landmark);
    Reprojection at;
    term.visible = reproject(camera(state, term.view), state.T_room_sensor[term.view], p_room, term.centre_px, at).ok();
    if (!term.visible) continue;
    term.r = term.W * at.residual_px;
    term.J_pose = term.W * at.J_pose;
    if (!landmarks[term.landmark].exact) term.J_u = (term.W * at.J_point) * landmarks[term.landmark].L;
    if (const std::size_t lens = views[term.view].lens; lens != kHeldLens)
      J_lens[i] = (term.W * at.J_intrinsics) * lenses[lens].sigma.asDiagonal();
  }
}

double JointProblem::reweight() {
  double sum = 0;
  for (Term& term : terms) {
    const RedescendingLoss loss(views[term.view].turn_over);
    const LossAndWeight lw = term.visible ? loss(term.r.squaredNorm()) : LossAndWeight{loss.max_loss(), 0};
    term.weight = lw.weight;
    sum += lw.loss;
  }
  for (std::size_t l = 0; l < landmarks.size(); ++l)
    if (!landmarks[l].exact) sum += state.u[l].squaredNorm();
  return sum + lens_cost(state) + lidar_cost(*this, state);
}

void JointProblem::update_turn_over() {
  for (ViewTerms& view : views) {
    std::size_t count = 0;
    for (const Term& term : terms.subspan(view.first, view.count))
      if (term.visible) sorted[count++] = term.r.squaredNorm();
    if (count == 0) continue;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(count));
    const double typical = std::sqrt(*middle / kMedianOfSquare);
    view.turn_over = std::min(view.turn_over, robust_scale * std::max(1.0, typical));
  }
}

}  // namespace roomcal::rig
