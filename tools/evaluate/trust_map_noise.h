#pragma once

#include <cstdint>

#include "tools/evaluate/pair_tally.h"

namespace roomcal::tools {

/// Shots in rooms of which the map is noisy and says so: markers off by sigma_m per axis, planes fitted to them.
struct MapNoiseTally {
  double sigma_m = 0;
  int shots = 0;
  int passed = 0;  ///< that may be written
  PairTallies pairs;
};

/// One shot with a map of its own.
void run_map_noise_trial(const TrustRoom& room, uint64_t seed, MapNoiseTally& tally);

}  // namespace roomcal::tools
