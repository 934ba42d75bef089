#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "runtime/map/room_map.h"
#include "tools/map/map_quality.h"

namespace roomcal::tools {

/// The page of `roomcal map info --report`: the map in 3-D, coloured by uncertainty, its markers, planes, figures,
/// advice and the sample looks of its coverage.
/// @param description, quality  of the same map, by describe_map() and measure_map_quality().
/// @param bake  what `roomcal bake --json` said of it, for the survey's path and the markers' statistics; null: not
/// known.
/// @throws ToolError if `bake` is of another map: fewer than half of its markers are in this one.
std::string map_report(const map::RoomMap& map, const nlohmann::ordered_json& description, const MapQuality& quality,
                       const nlohmann::ordered_json& bake);

}  // namespace roomcal::tools
