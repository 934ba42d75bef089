#pragma once

#include <cstdint>

#include "tools/map/map_data.h"

namespace roomcal::tools {

struct PlaneFitOptions {
  double tolerance_m = 0.015;   ///< distance of a marker's centre from its plane; walls bow by a few millimetres
  std::size_t min_markers = 6;  ///< fewer fit a plane by accident
  double min_spread_m = 0.15;   ///< RMS extent of a plane's markers along its narrow side; less is a line
  double max_normal_deg = 20;   ///< between a surveyed normal and the plane's
  int draws = 6000;             ///< finds a plane that holds a tenth of the markers with 99.7 %
  uint64_t seed = 1;
};

/// Planes that the markers lie on, largest first, and for each marker the number of its plane.
///
/// Sequential RANSAC over marker centres, each plane refitted to its markers by least squares. A plane's normal points
/// to the side of its markers' surveyed normals where there are any, else to the side with more of the other markers:
/// true for walls, floor and ceiling, and for a pillar's faces towards the bulk of the room.
/// @param[in,out] markers  `plane` is set on each; nothing else changes.
/// Deterministic for a seed. Cost: draws x markers per plane.
std::vector<PlaneData> fit_planes(std::vector<map::MapMarker>& markers, const PlaneFitOptions& options = {});

}  // namespace roomcal::tools
