#pragma once

#include <span>
#include <vector>

#include "runtime/marker/detector.h"
#include "tools/simulate/scene.h"
#include "tools/simulate/stand.h"

namespace roomcal::tools {

/// Cramer-Rao bound of the length between the first two cameras of a stand, 1-sigma, m: the best that any estimate
/// without bias can do with these rings and a map that is off by independent normal noise.
///
/// Unknown: both poses and the place of every marker that is seen, which have the map as prior. Fisher information at
/// the truth, markers eliminated; knows nothing of the runtime's solver.
/// @param rings        of each camera; each is the marker whose true centre lies nearest
/// @param map_sigma_m  per axis; 0: the map is exact
double baseline_bound_m(const Scene& scene, const Stand& stand, std::span<const std::vector<marker::Detection>> rings,
                        double map_sigma_m);

}  // namespace roomcal::tools
