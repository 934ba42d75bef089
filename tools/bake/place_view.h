#pragma once

#include <vector>

#include "tools/align/triangle_match.h"
#include "tools/bake/reconstruction.h"
#include "tools/bake/stereo_match.h"

namespace roomcal::tools {

struct TrackOptions {
  StereoMatchOptions stereo;
  TriangleMatchOptions match;
  std::size_t recent = 8;      ///< views before, whose points a new one is matched with
  std::size_t min_points = 4;  ///< measured left and right, for a view to be placed
  double min_met = 0.35;       ///< of the points that should be in the image
};

/// Tries to place a view in a map by matching it with `local` (numbers of points).
/// @return false, the view unplaced, unless enough of the local points agree and no other place is as good.
bool place_view(const Survey& survey, const std::vector<StereoPoint>& stereo, const std::vector<std::size_t>& local,
                const TrackOptions& options, Reconstruction& map, std::size_t view);

/// Points that were triangulated in a placed view and have no number yet get one, unless one of the map is closer than
/// min_distance_m. @return how many.
std::size_t add_new_points(const std::vector<StereoPoint>& stereo, Reconstruction& map, std::size_t view,
                           double min_distance_m = 0);

/// Numbers of all points of the map.
std::vector<std::size_t> all_points(const Reconstruction& map);

}  // namespace roomcal::tools
