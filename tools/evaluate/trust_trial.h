#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/evaluate/trust_shot.h"

namespace roomcal::tools {

/// One sensor against the installed record, moved or not.
struct MoveTally {
  int shots = 0;
  int refused = 0;       ///< FAIL verdict, nothing is said about moving
  int false_alarms = 0;  ///< something called moved where nothing was
  int moved = 0;         ///< shots with a sensor moved
  int unseen = 0;        ///< of these, moved along a direction that a report calls not observed
  int named = 0;         ///< of the others, named rightly
  int misnamed = 0;      ///< another sensor was named
  std::map<std::string, std::vector<double>> nees;  ///< "cam0-lidar1" -> one value a shot
};

/// An installed record from one place; from another, one shot unmoved and one with a sensor moved by 5 mm or 0.3
/// degree.
void run_move_trial(const TrustRoom& room, uint64_t seed, const TrustDeviceOptions& options, MoveTally& tally);

}  // namespace roomcal::tools
