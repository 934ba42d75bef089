#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "tools/evaluate/trust_shot.h"

namespace roomcal::tools {

/// Shots that a device meets. All but the first must be refused or come out right.
enum class ShotKind : uint8_t {
  kClean,
  kMarkersMoved,
  kHalfDark,
  kWrongRoom,
  kMirror,
  kDoorOpen,
  kOperator,
  kFurniture,
  kLooseCamera,
  kLidarBlinded,
  kCameraElsewhere,
  kMirroredMap
};
inline constexpr std::array kShotKinds = {ShotKind::kClean,        ShotKind::kMarkersMoved,    ShotKind::kHalfDark,
                                          ShotKind::kWrongRoom,    ShotKind::kMirror,          ShotKind::kDoorOpen,
                                          ShotKind::kOperator,     ShotKind::kFurniture,       ShotKind::kLooseCamera,
                                          ShotKind::kLidarBlinded, ShotKind::kCameraElsewhere, ShotKind::kMirroredMap};
const char* to_string(ShotKind kind);

/// Room number `number` of a seed: a box of 2.7 to 4.5 by 3 to 6 by 2.4 to 3 m with five to six and a half sheets a
/// square metre.
Scene draw_trust_scene(uint64_t seed, uint64_t number);

/// The room as a shot of this kind finds it, with the map that the device carries.
TrustRoom upset(ShotKind kind, const TrustRoom& room, const TrustRoom& other, Random& random);

/// A device that stands in a room, and what is wrong with itself.
struct ShotSetup {
  /// A camera that stands in another room.
  struct Elsewhere {
    std::size_t camera = 0;
    SE3 T_room_rig;  ///< there
  };
  TrustDevice device;
  SE3 T_room_rig;
  TrustFlaws flaws;
  std::optional<Elsewhere> elsewhere;
};
/// @param room  upset. @param scale  of the cameras' resolution
ShotSetup set_up(ShotKind kind, const TrustRoom& room, const TrustRoom& other, uint64_t seed, double scale);

}  // namespace roomcal::tools
