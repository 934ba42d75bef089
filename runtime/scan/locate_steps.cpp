#include "runtime/scan/locate_steps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "runtime/scan/planes.h"
#include "runtime/scan/ray_cast.h"

namespace roomcal::scan {

namespace {

constexpr std::size_t kAzimuthBins = 36;

}  // namespace

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

void find_places(const Samples& samples, const RefineInput& input, const LocateOptions& options,
                 CandidateSet& candidates, Hypotheses& hypotheses) {
  const double total_sigma_m = std::hypot(input.sensor.sigma_m, input.sensor.beam_offset_sigma_m);
  const SweepPlanes planes = extract_planes(samples.fine, total_sigma_m);
  find_hypotheses(input.surface, samples.probe, planes, input.prior, hypotheses);
  candidates.settle_all(samples, input, hypotheses, options.accept, options.twin_loss);
}

double azimuth_coverage(std::span<const RayBlock> sample, const RefineInput& input, const RangeState& state) {
  const PosedSurface posed(input.surface, state.T_room_lidar);
  std::array<bool, kAzimuthBins> covered{};
  const double reach_m = 4 * input.sigma_m;
  for (const RayBlock& block : sample) {
    BlockHits hits;
    posed.cast(block, hits);
    for (std::size_t i = 0; i < block.count; ++i) {
      if (!(posed.height_m()[static_cast<std::size_t>(hits.face[i])] > 0)) continue;
      const auto off_m = static_cast<double>(block.range_m[i] - 1 / hits.inverse_m[i]);
      if (std::abs(off_m - state.offset_m[block.beam[i]]) > reach_m) continue;
      const double turn = static_cast<double>(std::atan2(block.y[i], block.x[i])) / (2 * kPi) + 0.5;
      covered[std::min(kAzimuthBins - 1, static_cast<std::size_t>(turn * static_cast<double>(kAzimuthBins)))] = true;
    }
  }
  return static_cast<double>(std::count(covered.begin(), covered.end(), true)) / static_cast<double>(kAzimuthBins);
}

void fill_counts(const RangeSums& sums, const SensorModel& sensor, double sigma_m, const RangeState& state,
                 Location& location) {
  location.points = sums.valid;
  location.inliers = sums.inliers;
  location.shares = shares_of(sums, sensor, sigma_m, state);
  location.sigma_m = sigma_m;
  location.rms_m = sigma_m * std::sqrt(sums.inlier_squares / std::max(1.0, static_cast<double>(sums.inliers)));
}

void refuse(Location& location, const char* reason) {
  location.outcome = LocateOutcome::kRefused;
  location.reason = reason;
}

void conclude(bool converged, const AcceptanceLimits& accept, Location& location) {
  const char* reason = converged ? why_refused(location.shares, accept) : "the solution did not settle";
  if (*reason == '\0' && location.azimuth < accept.min_azimuth) {
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
}

}  // namespace roomcal::scan
