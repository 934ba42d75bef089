#pragma once

#include "tools/map/map_builder.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// The exact markers of a simulated room as a map's data, completed (planes, triangles).
MapData map_data_of(const Scene& scene);

/// Built and opened.
LoadedMap open_map(const MapData& data);

}  // namespace roomcal::tools
