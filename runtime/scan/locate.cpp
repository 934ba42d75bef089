#include "runtime/scan/locate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "runtime/scan/candidates.h"
#include "runtime/scan/locate_steps.h"
#include "runtime/scan/planes.h"
#include "runtime/scan/print_fit.h"

namespace roomcal::scan {

namespace {

constexpr double kOpenSigma_m = 0.01;     // an axis that the sample fixes worse is searched
constexpr double kCloseSigma_m = 0.002;   // prints are asked for an axis that ranges fix worse
constexpr double kUnknownReach_m = 1.0;   // of prints, without a prior
constexpr double kRepeatReach_m = 0.15;   // of a second look, from where the first one led
constexpr double kPrintsAgree_m = 0.004;  // two looks
constexpr int kPrintRounds = 4;
constexpr double kPrintSigma_m = 0.0005;  // surveys do not place sheets better
constexpr double kTwinRunnerUp = 0.5;     // of the best twin's gain
constexpr double kOpenReach_m = 0.45;     // how far, without a prior's word
constexpr double kOpenStep_m = 0.025;     // the loss reaches 45 mm along a ray

/// What locate() keeps in scratch.
struct Workspace {
  Samples samples;
  std::span<float> residuals;
  CandidateSet* candidates = nullptr;
  PrintMatcher matcher;

  static Status build(const SweepView& view, const SensorModel& sensor, Arena& scratch, Workspace& work) {
    ROOMCAL_TRY(Samples::take(view, sensor, scratch, work.samples));
    work.residuals = scratch.allocate<float>(Samples::kMaxRays);
    const std::span<CandidateSet> set = scratch.allocate<CandidateSet>(1);
    if (work.residuals.empty() || set.empty()) {
      return out_of_arena("scan: scratch arena too small, see locate_scratch_bytes()");
    }
    work.candidates = set.data();
    return PrintMatcher::build(scratch, work.matcher);
  }
};

/// The axis of position that ranges fix least, and how far along it the sensor may be.
struct OpenAxis {
  Vec3 axis_room = Vec3::UnitZ();
  double sigma_m = 0;
  double reach_m = 0;  ///< 0: it is not open
};

OpenAxis open_axis_of(const Mat66& information, const Mat33& R, const PosePrior* prior, double unknown_reach_m) {
  const Eigen::SelfAdjointEigenSolver<Mat33> axes(R * covariance_of(information).topLeftCorner<3, 3>() * R.transpose());
  OpenAxis open;
  open.axis_room = axes.eigenvectors().col(2);
  open.sigma_m = std::sqrt(std::max(0.0, axes.eigenvalues()[2]));
  if (open.sigma_m < kOpenSigma_m) return open;
  open.reach_m = unknown_reach_m;
  if (prior != nullptr) {
    const Vec3 axis_lidar = R.transpose() * open.axis_room;
    open.reach_m = std::min(1.0, 3 * std::sqrt(axis_lidar.dot(prior->cov.topLeftCorner<3, 3>() * axis_lidar)));
  }
  return open;
}

/// The same of a candidate, judged without faces that only seem to be seen.
OpenAxis open_axis_of(std::span<const RayBlock> sample, const RefineInput& input, const Candidate& candidate,
                      double unknown_reach_m) {
  RangeSums sums;
  gather(input.surface, sample, input.sensor, candidate.state, {input.sigma_m, 3, 0, true}, sums);
  RefineInput muted = input;
  muted.mute = faces_without_evidence(sums);
  Candidate probe = candidate;
  (void)judge(sample, muted, probe);
  return open_axis_of(probe.information, candidate.state.T_room_lidar.R, input.prior, unknown_reach_m);
}

/// Moves a settled state along its most open axis of position to where the sample fits best: Gauss-Newton does not find
/// the few points on a floor 0.2 m away.
void search_open_axis(std::span<const RayBlock> sample, const RefineInput& input, Candidate& candidate) {
  const OpenAxis open = open_axis_of(sample, input, candidate, kOpenReach_m);
  if (open.reach_m == 0) return;
  // Flat ground is no reason to move, nor is bringing points before walls of which nothing is known, or away from them.
  constexpr double kBetter = 0.01;
  const auto better = [](const Candidate& a, const Candidate& b) {
    return a.loss < b.loss - kBetter && a.mapped_loss < b.mapped_loss - kBetter;
  };
  const int steps = static_cast<int>(open.reach_m / kOpenStep_m);
  Candidate best = candidate;
  for (int step = -steps; step <= steps; ++step) {
    Candidate moved = candidate;
    moved.state.T_room_lidar.t += open.axis_room * (kOpenStep_m * step);
    (void)judge(sample, input, moved);
    if (better(moved, best)) best = moved;
  }
  // No wide loss here: what fixes the axis are few points, which the many around them would outvote.
  settle_near(sample, input, best.state);
  (void)judge(sample, input, best);
  if (better(best, candidate)) candidate = best;
}

void fill_beams(const RangeSums& sums, const SensorModel& sensor, const RangeState& state, Location& location) {
  const double sigma_m = sensor.beam_offset_sigma_m;
  location.beam_count = 0;
  for (std::size_t k = 0; k < kMaxBeams; ++k) {
    const RangeSums::Beam& beam = sums.beam[k];
    location.beam[k] = {state.offset_m[k], sigma_m, beam.points};
    if (beam.points == 0) continue;
    location.beam_count = k + 1;
    if (sigma_m <= 0) continue;
    const double pivot = beam.weight + 1 / (sigma_m * sigma_m);
    location.beam[k].sigma_m = std::sqrt(1 / pivot + beam.v.dot(location.cov * beam.v) / (pivot * pivot));
  }
}

/// Keeps the twin whose view of the prints matches, if one clearly does.
/// @return false if prints should tell, and none of the places matches them: the right one may not be among them.
bool tell_twins_apart(const SweepView& view, std::span<const RayBlock> sample, const RefineInput& input,
                      PrintMatcher& matcher, CandidateSet& candidates) {
  std::array<double, kMaxTwins> gain{};
  std::size_t best = 0;
  bool informative = false;
  for (std::size_t i = 0; i < candidates.twins.size(); ++i) {
    const Candidate& twin = candidates.twins[i];
    const OpenAxis open = open_axis_of(sample, input, twin, kUnknownReach_m);
    const PrintFit fit = matcher.fit(input.surface, view, input.sensor, twin.state, open.axis_room, open.reach_m);
    informative |= fit.informative;
    gain[i] = fit.gain;
    if (gain[i] > gain[best]) best = i;
  }
  double runner_up = 0;
  for (std::size_t i = 0; i < candidates.twins.size(); ++i) {
    if (i != best) runner_up = std::max(runner_up, gain[i]);
  }
  if (gain[best] < PrintMatcher::kSignificant) return !informative;
  if (runner_up > kTwinRunnerUp * gain[best]) return true;
  candidates.twins[0] = candidates.twins[best];
  candidates.twins.truncate(1);
  return true;
}

/// What the prints measured, as information on the pose: J xi = 0 at the moved pose, with
///     J = (R' a, c x R' a),  a: the axis,  c: where the prints are in the sensor's frame.
struct PrintMeasurement {
  Vec6 J = Vec6::Zero();
  double weight = 0;  ///< 0: none
};

/// Measures an axis that ranges leave open by the prints, and solves again with it.
PrintMeasurement close_axis(const SweepView& view, const Mat66& information, PrintMatcher& matcher, RefineInput input,
                            RangeState& state, RangeSums& sums, RangeState& linearized_at, Location& location) {
  PrintMeasurement measured;
  const Mat33& R = state.T_room_lidar.R;
  const OpenAxis open = open_axis_of(information, R, input.prior, kUnknownReach_m);
  if (open.sigma_m < kCloseSigma_m) return measured;
  double reach_m = std::clamp(3 * open.sigma_m, kRepeatReach_m, std::max(kRepeatReach_m, open.reach_m));
  // A fit holds the faces as they are seen from where it starts: it is repeated until it starts where it ends.
  RangeState moved = state;
  PrintFit fit;
  for (int round = 0; round < kPrintRounds; ++round) {
    fit = matcher.fit(input.surface, view, input.sensor, moved, open.axis_room, reach_m);
    if (!fit.clear) return measured;
    moved.T_room_lidar.t += fit.shift_m * open.axis_room;
    if (std::abs(fit.shift_m) < kPrintsAgree_m) break;
    reach_m = kRepeatReach_m;
  }
  if (std::abs(fit.shift_m) >= kPrintsAgree_m) return measured;
  const Vec3 axis_lidar = R.transpose() * open.axis_room;
  measured.J << axis_lidar, fit.centre_lidar.cross(axis_lidar);
  const double sigma_m = std::max(kPrintSigma_m, fit.sigma_m);
  measured.weight = 1 / (sigma_m * sigma_m);
  location.print_points = fit.points;

  state = moved;
  Mat66 joined = measured.weight * measured.J * measured.J.transpose() + 1e-3 * Mat66::Identity();
  if (input.prior != nullptr) joined += input.prior->cov.inverse();
  const PosePrior with_prints{state.T_room_lidar, joined.inverse()};
  input.prior = &with_prints;
  (void)refine(view, input, state, sums, linearized_at);
  return measured;
}

void fill_pose(const RefineInput& input, const RangeSums& sums, const RangeState& state,
               const RangeState& linearized_at, const PrintMeasurement& prints, const LocateOptions& options,
               Location& location) {
  location.T_room_lidar = state.T_room_lidar;
  location.information = condense(sums, input.sensor, linearized_at);
  location.information.information += prints.weight * prints.J * prints.J.transpose();
  location.weak = find_weak_directions(location.information.information, state.T_room_lidar.R, options.observe);
  Mat66 with_prior = location.information.information;
  Vec6 unused = Vec6::Zero();
  if (input.prior != nullptr) add_prior(*input.prior, state.T_room_lidar, with_prior, unused);
  location.cov = covariance_of(with_prior);
}

}  // namespace

const char* to_string(LocateOutcome outcome) {
  switch (outcome) {
    case LocateOutcome::kLocated:
      return "located";
    case LocateOutcome::kAmbiguous:
      return "ambiguous";
    case LocateOutcome::kRefused:
      return "refused";
  }
  return "";
}

std::size_t locate_scratch_bytes() {
  return Samples::bytes() + Samples::kMaxRays * sizeof(float) + sizeof(CandidateSet) + PrintMatcher::bytes() + 256;
}

Status locate(const Surface& surface, std::span<const lidar::Sweep> sweeps, const SensorModel& sensor,
              const PosePrior* prior, const LocateOptions& options, Arena& scratch, Location& location) {
  location = {};
  ROOMCAL_TRY(check_inputs(sweeps, sensor, prior));
  const Arena::Scope scope(scratch);
  const SweepView view{sweeps};
  Workspace work;
  ROOMCAL_TRY(Workspace::build(view, sensor, scratch, work));
  const std::span<const RayBlock> sample = work.samples.fine;
  if (ray_count(sample) < options.accept.min_points) {
    refuse(location, "too few usable points in the sweep: is the LiDAR running, and its view clear?");
    return ok_status();
  }
  const double total_sigma_m = std::hypot(sensor.sigma_m, sensor.beam_offset_sigma_m);
  const SweepPlanes planes = extract_planes(sample, total_sigma_m);
  Hypotheses hypotheses;
  find_hypotheses(surface, work.samples.probe, planes, prior, hypotheses);
  RefineInput input{surface, sensor, prior, sensor.sigma_m, 0};
  CandidateSet& candidates = *work.candidates;
  candidates.settle_all(work.samples, input, hypotheses, options.accept, options.twin_loss);
  if (candidates.twins.empty()) {
    refuse(location, "no place in the map fits the sweep: another room, or the prior is wrong");
    return ok_status();
  }
  // Without a prior a lone place is asked as well: its better twin may have been lost on the way.
  bool confirmed = true;
  if (options.use_reflectivity && (prior == nullptr || candidates.twins.size() > 1)) {
    confirmed = tell_twins_apart(view, sample, input, work.matcher, candidates);
  }
  Candidate& best = candidates.twins[0];
  search_open_axis(sample, input, best);
  input.sigma_m = spread_m(sample, input, best.state, work.residuals);

  RangeSums sums;
  RangeState state = best.state;
  RangeState linearized_at = state;
  const bool converged = refine(view, input, state, sums, linearized_at);
  PrintMeasurement prints;
  // Only within a prior's reach: over a metre, a wrong place has been seen to match (one of nine real and simulated
  // sets).
  if (options.use_reflectivity && converged && prior != nullptr) {
    const Mat66 information = condense(sums, sensor, linearized_at).information;
    prints = close_axis(view, information, work.matcher, input, state, sums, linearized_at, location);
  }
  fill_counts(sums, sensor, input.sigma_m, state, location);
  location.azimuth = azimuth_coverage(sample, input, state);
  fill_pose(input, sums, state, linearized_at, prints, options, location);
  fill_beams(sums, sensor, state, location);
  const int places = static_cast<int>(candidates.twins.size());
  location.twins = confirmed || prior != nullptr ? places : std::max(2, places);
  conclude(converged, options.accept, location);
  return ok_status();
}

}  // namespace roomcal::scan
