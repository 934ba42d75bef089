#pragma once

#include <vector>

#include "tools/bake/bundle.h"

namespace roomcal::tools {

/// Covariance of every point, all poses marginalized; with refine_rig the pair's calibration too, held by its prior.
///
/// Gauge: inner constraints, i.e. the frame is the one in which the points' own mean shift and turn is zero (Triggs et
/// al., "Bundle adjustment - a modern synthesis", 1999, section 9.4); no point is nailed down and the sum of variances
/// is the least possible. Scale: exact when the baseline is not refined; else as uncertain as its prior.
/// @param options  as in the last adjustment; sigma_px whitens, Cauchy's weights are those at the solution.
/// @return for every point number; zero where not alive.
/// @throws ToolError if the points do not hang together.
/// Cost: linear in the measurements, plus (3 points)^3.
std::vector<Mat33> map_covariance(const Survey& survey, const Reconstruction& map, const BundleOptions& options);

}  // namespace roomcal::tools
