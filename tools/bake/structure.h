#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "runtime/math/se3.h"
#include "tools/map/map_data.h"

namespace roomcal::tools {

/// Where two planes of the room meet.
struct RoomLine {
  std::size_t plane_a = 0, plane_b = 0;
  Vec3 from_room = Vec3::Zero(), to_room = Vec3::Zero();  ///< as far as both planes' markers reach, corners included
};

/// Where three planes of the room meet.
struct RoomCorner {
  std::array<std::size_t, 3> planes{};
  Vec3 p_room = Vec3::Zero();
};

struct Structure {
  std::optional<std::size_t> floor;  ///< plane; absent: none was found and the axes are the survey's
  std::string axes;                  ///< how the room frame was chosen, one line
  std::vector<RoomLine> lines;
  std::vector<RoomCorner> corners;
};

/// The room's own axes: z up, floor at z = 0, x along the shorter pair of walls' distance, origin in a floor corner
/// such that the room lies at positive x and y (CONVENTIONS.md); of the two corners that are left, the one nearer to
/// where the survey began.
///
/// The floor is the plane that lies below all markers, seen along `up_hint`, and faces up.
/// @param planes  of the markers, in the same frame. @param start  where the survey began.
/// @param up_hint  mean "up" of the cameras; decides between floor and ceiling and needs to be right within 60 degrees.
/// @param[out] structure  floor and axes.
/// @return T_room_survey.
SE3 find_axes(const std::vector<map::MapMarker>& markers, const std::vector<PlaneData>& planes, const Vec3& start,
              const Vec3& up_hint, Structure& structure);

/// Lines and corners of the planes, in the frame of the planes: pairs at more than 30 degrees whose markers both come
/// within `reach_m` of the common line; triples of them.
void find_edges(const std::vector<map::MapMarker>& markers, const std::vector<PlaneData>& planes, Structure& structure,
                double reach_m = 0.8);

}  // namespace roomcal::tools
