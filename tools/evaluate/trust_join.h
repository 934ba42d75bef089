#pragma once

#include <cstdint>

#include "tools/evaluate/pair_tally.h"
#include "tools/evaluate/trust_trial.h"

namespace roomcal::tools {

/// Several shots of one device, joined, and the first of them alone.
struct JoinTally {
  std::size_t shots_each = 3;
  double map_sigma_m = 0;  ///< noise of the map, which says so
  int trials = 0;
  int alone_passed = 0, joined_passed = 0;  ///< that may be written
  PairTallies alone, joined;

  int moved = 0;  ///< trials with one sensor moved between the shots by 5 mm or 0.3 degree
  int refused = 0;
  int named = 0;
  int false_alarms = 0;  ///< called moved between shots that nothing moved between
};

/// One device at several places in a room, each with its own errors, unmoved; then again with one sensor moved before
/// the last shot.
void run_join_trial(const TrustRoom& room, uint64_t seed, const TrustDeviceOptions& options, JoinTally& tally);

}  // namespace roomcal::tools
