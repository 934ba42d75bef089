#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/status.h"
#include "runtime/lidar/sweep.h"
#include "runtime/scan/locate.h"
#include "runtime/scan/refine.h"

/// Steps that every way to locate a sweep shares.
namespace roomcal::scan {

/// @return kInvalidArgument: no sweep, sigmas that are none, a prior without a positive definite covariance.
Status check_inputs(std::span<const lidar::Sweep> sweeps, const SensorModel& sensor, const PosePrior* prior);

/// Share of the sensor's horizon covered by points that fit.
double azimuth_coverage(std::span<const RayBlock> sample, const RefineInput& input, const RangeState& state);

/// How the points fit, as gathered at `state`.
void fill_counts(const RangeSums& sums, const SensorModel& sensor, double sigma_m, const RangeState& state,
                 Location& location);

void refuse(Location& location, const char* reason);

/// Outcome and reason from what is filled in: shares, azimuth, twins.
void conclude(bool converged, const AcceptanceLimits& accept, Location& location);

}  // namespace roomcal::scan
