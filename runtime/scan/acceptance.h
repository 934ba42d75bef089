#pragma once

#include <cstddef>

#include "runtime/scan/range_problem.h"

namespace roomcal::scan {

/// How much of a sweep must agree with the room. Defaults: people and furniture may hide a seventh of it.
/// A room whose walls stand 0.2 m elsewhere fits with 0.84 at best (two walls and the floor).
struct AcceptanceLimits {
  double min_mapped = 0.4;        ///< share of usable points with a known surface on their way
  double min_explained = 0.85;    ///< share of these within the robust loss's reach of it
  double max_beyond = 0.1;        ///< share of these that came from behind it: not this room, or another place in it
  double max_contradicted = 0.1;  ///< share on faces where fewer than a third fit: a wall that stands elsewhere
  double min_azimuth = 0.4;       ///< share of the sensor's horizon that is covered by points that fit
  double max_scatter = 1.6;       ///< RMS of the fitting ranges in the sensor's sigmas
  double max_offsets = 3;         ///< RMS of the beam offsets in sigmas of their prior: they must not explain a wall
  std::size_t min_points = 200;
};

/// How a sweep fits, as AcceptanceLimits names it.
struct FitShares {
  double mapped = 0, explained = 0, beyond = 0, contradicted = 0;
  double scatter = 0, offsets = 0;  ///< RMS, in sigmas
};
/// @param sigma_m  of one range, as the sums were whitened by.
FitShares shares_of(const RangeSums& sums, const SensorModel& sensor, double sigma_m, const RangeState& state);

/// One line with the remedy; empty if the shares are within the limits.
const char* why_refused(const FitShares& shares, const AcceptanceLimits& limits);

}  // namespace roomcal::scan
