#pragma once

#include <string>
#include <vector>

#include "runtime/math/se3.h"
#include "tools/map/map_data.h"

namespace roomcal::tools {

struct RoomAxes {
  SE3 T_room_survey;
  bool has_floor = false;   ///< false: no floor was found and the axes are the survey's
  std::string description;  ///< how the room frame was chosen, one line
};

/// The room's own axes: z up, floor at z = 0, x along the shorter pair of walls' distance, origin in a floor corner
/// such that the room lies at positive x and y (CONVENTIONS.md); of the two corners that are left, the one nearer to
/// where the survey began.
///
/// The floor is the plane that lies below all markers, seen along `up_hint`, and faces up.
/// @param planes  of the markers, in the same frame. @param start  where the survey began.
/// @param up_hint  mean "up" of the cameras; decides between floor and ceiling and needs to be right within 60 degrees.
RoomAxes find_axes(const std::vector<map::MapMarker>& markers, const std::vector<PlaneData>& planes, const Vec3& start,
                   const Vec3& up_hint);

}  // namespace roomcal::tools
