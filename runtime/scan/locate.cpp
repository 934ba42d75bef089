#include "runtime/scan/locate.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "runtime/scan/candidates.h"
#include "runtime/scan/planes.h"

namespace roomcal::scan {

namespace {

constexpr std::size_t kAzimuthBins = 36;
constexpr std::size_t kJudgePoints = 6000;
constexpr double kOpenSigma_m = 0.01;  // an axis that the sample fixes worse is searched
constexpr double kOpenReach_m = 0.45;  // how far, without a prior's word
constexpr double kOpenStep_m = 0.025;  // the loss reaches 45 mm along a ray

/// What locate() keeps in scratch.
struct Workspace {
  std::span<Ray> sample;
  std::span<float> residuals;
  CandidateSet* candidates = nullptr;

  static Status build(Arena& scratch, Workspace& work) {
    work.sample = scratch.allocate<Ray>(kMaxSample);
    work.residuals = scratch.allocate<float>(kMaxSample);
    const std::span<CandidateSet> set = scratch.allocate<CandidateSet>(1);
    if (work.sample.empty() || work.residuals.empty() || set.empty()) {
      return out_of_arena("scan: scratch arena too small, see locate_scratch_bytes()");
    }
    work.candidates = set.data();
    return ok_status();
  }
};

Status check_inputs(std::span<const lidar::Sweep> sweeps, const SensorModel& sensor, const PosePrior* prior) {
  if (sweeps.empty()) return {StatusCode::kInvalidArgument, "scan: no sweep"};
  if (!(sensor.sigma_m > 0 && sensor.beam_offset_sigma_m >= 0 && sensor.angle_sigma_rad >= 0)) {
    return {StatusCode::kInvalidArgument, "scan: the sensor's sigmas must be positive"};
  }
  if (prior == nullptr) return ok_status();
  if (!prior->T_room_lidar.R.allFinite() || !prior->T_room_lidar.t.allFinite() || !prior->cov.allFinite() ||
      prior->cov.llt().info() != Eigen::Success) {
    return {StatusCode::kInvalidArgument, "scan: the prior's covariance must be positive definite"};
  }
  return ok_status();
}

/// Rays spread over the joined sweeps. @return how many.
std::size_t take_sample(const SweepView& view, const SensorModel& sensor, std::span<Ray> sample) {
  std::size_t count = 0;
  const std::size_t stride = (view.point_count() + sample.size() - 1) / sample.size();
  for_each_ray(view, sensor, std::max<std::size_t>(1, stride), [&](const Ray& ray) {
    if (count < sample.size()) sample[count++] = ray;
  });
  return count;
}

/// Moves a settled state along its most open axis of position to where the sample fits best: Gauss-Newton does not find
/// the few points on a floor 0.2 m away. Open is judged without faces that only seem to be seen.
void search_open_axis(std::span<const Ray> sample, const RefineInput& input, Candidate& candidate) {
  RefineInput muted = input;
  muted.mute = faces_without_evidence(sample, input, candidate.state);
  Candidate probe = candidate;
  (void)judge(sample, muted, probe);
  const Mat66 cov = covariance_of(probe.information);
  const Eigen::SelfAdjointEigenSolver<Mat33> axes(cov.topLeftCorner<3, 3>());
  if (axes.eigenvalues()[2] < kOpenSigma_m * kOpenSigma_m) return;
  const Vec3 axis_lidar = axes.eigenvectors().col(2);
  double reach_m = kOpenReach_m;
  if (input.prior != nullptr) {
    const double prior_sigma_m = std::sqrt(axis_lidar.dot(input.prior->cov.topLeftCorner<3, 3>() * axis_lidar));
    reach_m = std::min(1.0, 3 * prior_sigma_m);
  }
  // Flat ground is no reason to move, nor is bringing points before walls of which nothing is known, or away from them.
  constexpr double kBetter = 0.01;
  const auto better = [](const Candidate& a, const Candidate& b) {
    return a.loss < b.loss - kBetter && a.mapped_loss < b.mapped_loss - kBetter;
  };
  const int steps = static_cast<int>(reach_m / kOpenStep_m);
  Candidate best = candidate;
  for (int step = -steps; step <= steps; ++step) {
    Candidate moved = candidate;
    moved.state.T_room_lidar.t += moved.state.T_room_lidar.R * axis_lidar * (kOpenStep_m * step);
    (void)judge(sample, input, moved);
    if (better(moved, best)) best = moved;
  }
  // No wide loss here: what fixes the axis are few points, which the many around them would outvote.
  settle_near(sample, input, 1, best.state);
  (void)judge(sample, input, best);
  if (better(best, candidate)) candidate = best;
}

double azimuth_coverage(const SweepView& view, const RefineInput& input, const RangeState& state) {
  PosedSurface posed;
  posed.set(input.surface, state.T_room_lidar);
  std::array<bool, kAzimuthBins> covered{};
  const double reach_m = 4 * input.sigma_m;
  for_each_ray(view, input.sensor, stride_for(view, kJudgePoints), [&](const Ray& ray) {
    const RayHit hit = posed.first_hit(ray.direction_lidar);
    if (hit.face == kNoFace || std::abs(ray.range_m - hit.range_m - state.offset_m[ray.beam]) > reach_m) return;
    const double turn = std::atan2(ray.direction_lidar.y(), ray.direction_lidar.x()) / (2 * kPi) + 0.5;
    covered[std::min(kAzimuthBins - 1, static_cast<std::size_t>(turn * static_cast<double>(kAzimuthBins)))] = true;
  });
  return static_cast<double>(std::count(covered.begin(), covered.end(), true)) / static_cast<double>(kAzimuthBins);
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

void fill_counts(const RangeSums& sums, const SensorModel& sensor, double sigma_m, const RangeState& state,
                 Location& location) {
  location.points = sums.valid;
  location.inliers = sums.inliers;
  location.shares = shares_of(sums, sensor, sigma_m, state);
  location.sigma_m = sigma_m;
  location.rms_m = sigma_m * std::sqrt(sums.inlier_squares / std::max(1.0, static_cast<double>(sums.inliers)));
}

/// The fine solution: all points, offsets, and only faces that the sweep gives evidence for.
bool solve_fine(const SweepView& view, RefineInput& input, RangeState& state, RangeSums& sums,
                RangeState& linearized_at) {
  const bool converged = refine(view, input, state, sums, linearized_at);
  // Grazing beams that change sides keep a solution from settling: mute first, complain later.
  input.mute = faces_without_evidence(view, input, state);
  return input.mute == 0 ? converged : refine(view, input, state, sums, linearized_at);
}

void refuse(Location& location, const char* reason) {
  location.outcome = LocateOutcome::kRefused;
  location.reason = reason;
}

void fill_pose(const RefineInput& input, const RangeSums& sums, const RangeState& state,
               const RangeState& linearized_at, const LocateOptions& options, Location& location) {
  location.T_room_lidar = state.T_room_lidar;
  location.information = condense(sums, input.sensor, linearized_at);
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

std::size_t locate_scratch_bytes() { return kMaxSample * (sizeof(Ray) + sizeof(float)) + sizeof(CandidateSet) + 256; }

Status locate(const Surface& surface, std::span<const lidar::Sweep> sweeps, const SensorModel& sensor,
              const PosePrior* prior, const LocateOptions& options, Arena& scratch, Location& location) {
  location = {};
  ROOMCAL_TRY(check_inputs(sweeps, sensor, prior));
  const Arena::Scope scope(scratch);
  Workspace work;
  ROOMCAL_TRY(Workspace::build(scratch, work));

  const SweepView view{sweeps};
  const std::span<const Ray> sample = work.sample.first(take_sample(view, sensor, work.sample));
  if (sample.size() < options.accept.min_points) {
    refuse(location, "too few usable points in the sweep: is the LiDAR running, and its view clear?");
    return ok_status();
  }
  const double total_sigma_m = std::hypot(sensor.sigma_m, sensor.beam_offset_sigma_m);
  const SweepPlanes planes = extract_planes(sample, total_sigma_m);
  Hypotheses hypotheses;
  find_hypotheses(surface, sample, planes, prior, hypotheses);
  RefineInput input{surface, sensor, prior, sensor.sigma_m, 0};
  CandidateSet& candidates = *work.candidates;
  candidates.settle_all(sample, input, hypotheses, options.accept, options.twin_loss);
  if (candidates.twins.empty()) {
    refuse(location, "no place in the map fits the sweep: another room, or the prior is wrong");
    return ok_status();
  }
  Candidate& best = candidates.twins[0];
  search_open_axis(sample, input, best);
  input.sigma_m = spread_m(sample, input, best.state, work.residuals);

  RangeSums sums;
  RangeState state = best.state;
  RangeState linearized_at = state;
  const bool converged = solve_fine(view, input, state, sums, linearized_at);
  fill_counts(sums, sensor, input.sigma_m, state, location);
  location.azimuth = azimuth_coverage(view, input, state);
  fill_pose(input, sums, state, linearized_at, options, location);
  fill_beams(sums, sensor, state, location);
  location.twins = static_cast<int>(candidates.twins.size());
  const char* reason = converged ? why_refused(location.shares, options.accept) : "the solution did not settle";
  if (*reason == '\0' && location.azimuth < options.accept.min_azimuth) {
    reason = "the LiDAR sees too little of its horizon: clear its view";
  }
  if (*reason != '\0') {
    refuse(location, reason);
  } else if (location.twins > 1) {
    location.outcome = LocateOutcome::kAmbiguous;
    location.reason = "the room looks the same from several places: give a nominal mounting or locate a camera";
  } else {
    location.outcome = LocateOutcome::kLocated;
  }
  return ok_status();
}

}  // namespace roomcal::scan
