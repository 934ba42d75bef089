#pragma once

#include "tools/map/map_data.h"

namespace roomcal::tools {

struct StructureOptions {
  double reach_m = 0.8;        ///< planes meet where markers of both come this near to their common line
  double off_side_m = 0.05;    ///< a marker farther than this behind another plane says that its own goes on there
  double off_corner_m = 0.05;  ///< of a corner from the three outlines
};

/// Edges and corners of the room, and outlines that reach as far as its planes do: from planes with their markers'
/// hulls (plane_fit.h), for whatever source the markers came from.
///
/// Two planes at more than 30 degrees that both have markers near their common line meet there. Such a line bounds a
/// plane if all its markers are on one side of the other plane; the plane is extended to it, and along it as far as
/// its own markers reach, which makes walls rectangles down into their corners. A plane's open side ends with its
/// outermost sheets. Lines are what both outlines share; corners are where three lines meet within three outlines.
/// @param[in,out] data  outlines, lines and corners are set. Cost: planes^2 x markers.
void find_structure(MapData& data, const StructureOptions& options = {});

}  // namespace roomcal::tools
