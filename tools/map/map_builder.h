#pragma once

#include "tools/common/files.h"
#include "tools/map/map_data.h"

namespace roomcal::tools {

/// The bytes of a `*.room` file (runtime/map/format.h). The same data gives the same bytes.
///
/// Markers must come by ascending id (complete_map() sorts them). The result was opened by RoomMap::open(), so what
/// this writes, a device reads.
/// @throws ToolError for data that a map cannot hold, naming what.
AlignedBytes build_map(const MapData& data);

/// Everything that is in an opened map, so that a tool may change and build it again.
MapData to_map_data(const map::RoomMap& map);

/// A map file, opened; the view lives as long as this.
struct LoadedMap {
  AlignedBytes bytes;
  map::RoomMap map;
};

/// @throws ToolError naming the file and why it was refused.
LoadedMap load_map(const std::filesystem::path& path);

}  // namespace roomcal::tools
