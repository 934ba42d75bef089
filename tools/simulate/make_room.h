#pragma once

#include <cstdint>
#include <vector>

#include "tools/plan/wall.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

struct RoomOptions {
  uint64_t seed = 1;
  int markers = 340;
  Vec3 size = Vec3(3, 4, 2.7);  ///< width, depth, height, m
  bool pillar = false;
  int distractors = 10;          ///< discs, one- and two-ring targets, fans, text
  int boxes = 0;                 ///< things standing about: they hide markers and throw shadows
  int furniture = 0;             ///< tables, cabinets, shelves, ducts at the walls, put there after the sheets
  double waviness_m = 0;         ///< standard deviation of every surface from its plane
  std::vector<Wall> walls = {};  ///< a room of any planar layout instead of a box; then `size` says nothing
};

/// A random room: a box with walls up to half a degree out of true, or walls as drawn; A4 sheets that do not overlap,
/// lamps of unequal strength. The same options give the same room on every machine.
/// @throws ToolError when the sheets do not fit, or the size is no room.
Scene make_room(const RoomOptions& options);

}  // namespace roomcal::tools
