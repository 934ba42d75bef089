#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "runtime/math/se3.h"

namespace roomcal::tools {

/// One stereo key-frame of the paper's survey: undistorted ring centres; left and right belong together by index.
struct AnchorFrame {
  uint32_t id = 0;
  SE3 T_room_left;  ///< the file's pose, for judging only
  std::vector<Vec2> left_px;
  std::vector<Vec2> right_px;
  /// Map point (its place in AnchorRoom::point_room) of each key point, -1 if none: for fitting the stereo pair and for
  /// judging; the locator never sees it.
  std::vector<int> point;
};

/// What the paper's authors released: map points and key-frames.
struct AnchorRoom {
  std::vector<uint32_t> point_id;
  std::vector<Vec3> point_room;
  std::vector<AnchorFrame> frames;
};

/// Reads `MapPoints: {id: {position, projections}}` and `FramePoses: {id: {pose, 2dKeypointsLeft, 2dKeypointsRight}}`.
///
/// A reader for this one layout, a key and its value a line: a general YAML reader takes seconds for its 400,000
/// numbers. `pose` is a unit axis, an angle (rad) and a translation (m) of T_room_left.
/// @param name  of the file, for messages.
/// @throws ToolError "name:line: what", for numbers that are missing or not finite, too.
AnchorRoom parse_anchor_room(const std::string& name, const std::string& text);

}  // namespace roomcal::tools
