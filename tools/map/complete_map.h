#pragma once

#include "tools/map/map_data.h"

namespace roomcal::tools {

/// Makes what an importer read into a map: sorts the markers by id, finds the planes, gives markers without a normal
/// that of their plane (marked as estimated; a marker on no plane stays without), and bakes the triangle table.
/// @throws ToolError if a limit of runtime/map/format.h is passed.
void complete_map(MapData& data);

}  // namespace roomcal::tools
