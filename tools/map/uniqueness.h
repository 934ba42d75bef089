#pragma once

#include <cstdint>
#include <optional>

#include "tools/map/map_data.h"

namespace roomcal::tools {

/// How far a marker's neighbourhood is from the most similar other place of the room.
struct Uniqueness {
  int neighbours = 0;     ///< per constellation, beside the marker in its middle
  double worst_m = 0;     ///< the two most similar places of the room
  uint32_t worst_id = 0;  ///< their middle markers
  uint32_t worst_other_id = 0;
  double median_m = 0;
};

/// For every marker: its constellation (itself and its 8 nearest neighbours) is laid over every other marker's
/// surroundings, turned about the wall's normal so that a neighbour falls in line with a neighbour, and moved to the
/// least squares; the distance of the two places is the RMS from each laid-over marker to the marker nearest to it.
/// The figure of a marker is the least distance over all places and turns; the same place turned by more than 20
/// degrees counts as another.
///
/// Noise (per marker, RMS) that nears half of the figure makes the two places as likely as each other when only one
/// constellation is seen. Zero: a regular grid, which no camera can locate itself in.
/// @return nothing if the room has fewer than 18 markers.
/// Cost: about markers^2; two seconds for 340, with progress shown.
std::optional<Uniqueness> measure_uniqueness(const std::vector<map::MapMarker>& markers);

}  // namespace roomcal::tools
