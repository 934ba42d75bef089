#pragma once

#include <cstdint>

#include "tools/map/map_data.h"

namespace roomcal::tools {

/// Moves every marker by independent Gaussian noise of sigma_m per axis; seeded, the same everywhere.
///
/// @param declare  adds sigma_m^2 to the covariances, so that the rig weighs the map as it deserves. Without it the
///                 map lies about itself, which is what an experiment on over-confidence wants.
/// Planes are fitted anew to the markers that were on them; declared noise is then in their covariance as well. Normals
/// and triangles stay: noise of millimetres does not change which markers are neighbours.
void add_noise(MapData& data, double sigma_m, uint64_t seed, bool declare);

}  // namespace roomcal::tools
