#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/status.h"
#include "runtime/lidar/sweep.h"
#include "runtime/scan/candidates.h"
#include "runtime/scan/locate.h"
#include "runtime/scan/refine.h"

/// Steps that every way to locate a sweep shares.
namespace roomcal::scan {

/// @return kInvalidArgument: no sweep, sigmas that are none, a prior without a positive definite covariance.
Status check_inputs(std::span<const lidar::Sweep> sweeps, const SensorModel& sensor, const PosePrior* prior);

/// Reasons to refuse that every way shares.
inline constexpr const char* kTooFewPoints =
    "too few usable points in the sweep: is the LiDAR running, and its view clear?";
inline constexpr const char* kNoPlace = "no place in the map fits the sweep: another room, or the prior is wrong";

/// Coarse poses of a sweep from its planes, settled: none if nothing of it fits the map.
void find_places(const Samples& samples, const RefineInput& input, const LocateOptions& options,
                 CandidateSet& candidates, Hypotheses& hypotheses);

/// Share of the sensor's horizon covered by points that fit.
double azimuth_coverage(std::span<const RayBlock> sample, const RefineInput& input, const RangeState& state);

/// How the points fit, as gathered at `state`.
void fill_counts(const RangeSums& sums, const SensorModel& sensor, double sigma_m, const RangeState& state,
                 Location& location);

void refuse(Location& location, const char* reason);

/// Outcome and reason from what is filled in: shares, azimuth, twins.
void conclude(bool converged, const AcceptanceLimits& accept, Location& location);

}  // namespace roomcal::scan
