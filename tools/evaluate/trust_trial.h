#pragma once

#include <array>
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

enum class Trap : uint8_t {
  kWrongRoom,
  kMarkersMoved,
  kOtherRoomsCamera,
  kMirroredWall,
  kBlockedLidar,
  kUnmappedPillar
};
inline constexpr std::array kTraps = {Trap::kWrongRoom,    Trap::kMarkersMoved, Trap::kOtherRoomsCamera,
                                      Trap::kMirroredWall, Trap::kBlockedLidar, Trap::kUnmappedPillar};
const char* to_string(Trap trap);

struct TrapTally {
  int shots = 0;
  int refused = 0;
  int right = 0;
  int wrong = 0;  ///< would be written, and an extrinsic is off by more than 5 mm or 0.2 degree where called observed
};

struct TrustOptions {
  bool refine_intrinsics = false;  ///< of lenses that are off by a draw from their prior
};

/// An installed record from one place; from another, one shot unmoved and one with a sensor moved by 5 mm or 0.3
/// degree.
void run_move_trial(const TrustRoom& room, uint64_t seed, const TrustOptions& options, MoveTally& tally);

/// A shot that must be refused or come out right. @param room  with a pillar for kUnmappedPillar. @param other  another
/// room.
void run_trap(Trap trap, const TrustRoom& room, const TrustRoom& other, uint64_t seed, TrapTally& tally);

}  // namespace roomcal::tools
