#pragma once

#include <string>

#include "tools/map/map_data.h"

namespace roomcal::tools {

/// Markers of a CSV, metres, room frame: `id,x,y,z[,nx,ny,nz][,radius]`.
///
/// With a header line the columns may stand in any order, and normals or radius may be missing; without one the count
/// of columns decides: 4 (id x y z), 5 (with radius), 7 (with normal), 8 (all). A cell of an optional column may be
/// empty. Normals are scaled to unit length if they are within 1 % of it. `#` starts a comment line.
/// @param name  of the file, for messages.
/// @throws ToolError "name:line: field: ..." for NaN, a number missing or out of range, a duplicate id, no marker.
MapData parse_map_csv(const std::string& name, const std::string& text);

/// Markers of the map file that the paper's authors released: `MapPoints: {id: {position: [x, y, z], ...}}`, metres.
///
/// Everything else in it (projections, key-frame poses) is skipped. It knows no normals and no radius.
/// @throws ToolError "name:line: ..." as above.
MapData parse_map_yaml(const std::string& name, const std::string& text);

/// Either, by what the text looks like: a file with a `MapPoints:` line is the paper's, any other a CSV.
MapData parse_map_text(const std::string& name, const std::string& text);

}  // namespace roomcal::tools
