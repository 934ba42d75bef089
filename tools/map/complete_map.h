#pragma once

#include "tools/map/map_data.h"

namespace roomcal::tools {

/// Of the points that stand for the walls where a sweep is laid over them [P, III-C: the densified map].
inline constexpr double kSurfaceSpacing_m = 0.05;

/// Makes what an importer read into a map: sorts the markers by id, finds the planes, gives markers without a normal
/// that of their plane (marked as estimated; a marker on no plane stays without), finds outlines, edges and corners
/// (structure.h) and bakes the triangle table.
/// @throws ToolError if a limit of runtime/map/format.h is passed.
void complete_map(MapData& data);

}  // namespace roomcal::tools
