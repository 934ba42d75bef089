#include "runtime/scan/locate_by_gicp.h"

#include <algorithm>
#include <cmath>

#include "runtime/scan/locate_steps.h"

namespace roomcal::scan {

namespace {

constexpr double kTurnOver = 3;  // sigmas

/// The coarse pose that led to a place: how far off it is is GICP's to mend.
SE3 coarse_pose_of(const SE3& place, const Hypotheses& hypotheses) {
  const auto distance = [&](const Hypothesis& hypothesis) {
    return se3_log(place.inverse() * hypothesis.T_room_lidar).squaredNorm();
  };
  return std::min_element(hypotheses.begin(), hypotheses.end(),
                          [&](const Hypothesis& a, const Hypothesis& b) { return distance(a) < distance(b); })
      ->T_room_lidar;
}

/// What is not seen, GICP leaves where the coarse pose was: certain of nothing there.
void open_weak_axes(const Mat33& R_room_lidar, WeakDirections& weak, Mat66& cov) {
  for (WeakDirection& direction : weak) {
    direction.sigma = direction.rotation ? kUnseenSigma_rad : kUnseenSigma_m;
    Vec6 axis = Vec6::Zero();
    axis.segment<3>(direction.rotation ? 3 : 0) = R_room_lidar.transpose() * direction.axis_room;
    cov += direction.sigma * direction.sigma * axis * axis.transpose();
  }
}

/// What the rays say about the registered pose.
void fill_location(const SweepView& view, std::span<const RayBlock> sample, RefineInput& input,
                   const GicpResult& result, const LocateOptions& options, Location& location) {
  RangeState state;
  state.T_room_lidar = result.T_room_lidar;
  RangeSums sums;
  gather(input.surface, view, 1, input.sensor, state, {input.sigma_m, kTurnOver, 0, true}, sums);
  input.mute = faces_without_evidence(sums);
  gather(input.surface, view, 1, input.sensor, state, {input.sigma_m, kTurnOver, input.mute}, sums);
  fill_counts(sums, input.sensor, input.sigma_m, state, location);
  location.azimuth = azimuth_coverage(sample, input, state);
  location.T_room_lidar = state.T_room_lidar;
  location.information = condense(sums, input.sensor, state);
  location.weak = find_weak_directions(location.information.information, state.T_room_lidar.R, options.observe);
  location.cov = result.cov + covariance_of(location.information.information);
  open_weak_axes(state.T_room_lidar.R, location.weak, location.cov);
}

}  // namespace

std::size_t locate_by_gicp_scratch_bytes() {
  return Samples::bytes() + Samples::kMaxRays * sizeof(float) + sizeof(CandidateSet) + gicp_scratch_bytes() + 64;
}

Status locate_by_gicp(const Surface& surface, const GicpTarget& target, std::span<const lidar::Sweep> sweeps,
                      const SensorModel& sensor, const PosePrior* prior, const LocateOptions& options,
                      const GicpOptions& gicp, Arena& scratch, Location& location) {
  location = {};
  ROOMCAL_TRY(check_inputs(sweeps, sensor, prior));
  const Arena::Scope scope(scratch);
  const SweepView view{sweeps};
  Samples samples;
  ROOMCAL_TRY(Samples::take(view, sensor, scratch, samples));
  const std::span<float> residuals = scratch.allocate<float>(Samples::kMaxRays);
  const std::span<CandidateSet> set = scratch.allocate<CandidateSet>(1);
  if (residuals.empty() || set.empty()) {
    return out_of_arena("scan: scratch arena too small, see locate_by_gicp_scratch_bytes()");
  }
  const std::span<const RayBlock> sample = samples.fine;
  if (ray_count(sample) < options.accept.min_points) {
    refuse(location, kTooFewPoints);
    return ok_status();
  }
  RefineInput input{surface, sensor, prior, sensor.sigma_m, 0};
  CandidateSet& candidates = set[0];
  Hypotheses hypotheses;
  find_places(samples, input, options, candidates, hypotheses);
  if (candidates.twins.empty()) {
    refuse(location, kNoPlace);
    return ok_status();
  }
  const RangeState& place = candidates.twins[0].state;
  location.twins = static_cast<int>(candidates.twins.size());
  GicpResult result;
  const SE3 start_T_room_lidar = coarse_pose_of(place.T_room_lidar, hypotheses);
  const Status registered = register_by_gicp(target, view, sensor, start_T_room_lidar, gicp, scratch, result);
  if (registered.code() == StatusCode::kTooFew || registered.code() == StatusCode::kDegenerate) {
    refuse(location, "the sweep cannot be registered with the dense map: another room, or the view is blocked");
    return ok_status();
  }
  ROOMCAL_TRY(registered);
  RangeState state;
  state.T_room_lidar = result.T_room_lidar;
  input.sigma_m = spread_m(sample, input, state, residuals);
  fill_location(view, sample, input, result, options, location);
  conclude(result.converged, options.accept, location);
  return ok_status();
}

}  // namespace roomcal::scan
