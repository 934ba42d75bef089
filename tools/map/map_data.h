#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "runtime/map/room_map.h"

namespace roomcal::tools {

/// A plane of the room with its outline, as it goes into the file.
struct PlaneData {
  map::MapPlane plane;
  std::vector<Vec3> outline_room;  ///< convex, counter-clockwise seen from free space; may be empty
};

/// All of a room map, editable: what the importers fill, complete_map() enriches and build_map() writes.
struct MapData {
  std::string id;
  std::string provenance;      ///< one line: from which file, by which command
  int64_t created_unix_s = 0;  ///< 0: not recorded
  std::vector<map::MapMarker> markers;
  std::vector<PlaneData> planes;
  std::vector<std::array<uint16_t, 3>> triangles;
  std::vector<float> ring_ratios;
  std::vector<map::MapLine> lines;
  std::vector<map::MapCorner> corners;
  double surface_spacing_m = 0;  ///< 0: not recorded
};

}  // namespace roomcal::tools
