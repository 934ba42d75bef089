#pragma once

#include <cstdint>

#include "tools/simulate/scene.h"

namespace roomcal::tools {

struct RoomOptions {
  uint64_t seed = 1;
  int markers = 340;
  Vec3 size = Vec3(3, 4, 2.7);  ///< width, depth, height, m
  bool pillar = false;
  int distractors = 10;  ///< discs, one- and two-ring targets, fans, text
  int boxes = 0;         ///< things standing about: they hide markers and throw shadows
};

/// A random room: walls up to half a degree out of true, A4 sheets that do not overlap, lamps of unequal strength.
/// The same options give the same room on every machine.
/// @throws ToolError when the sheets do not fit, or the size is no room.
Scene make_room(const RoomOptions& options);

}  // namespace roomcal::tools
