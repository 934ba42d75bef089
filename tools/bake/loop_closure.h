#pragma once

#include "tools/bake/place_view.h"

namespace roomcal::tools {

struct LoopOptions {
  std::size_t far_apart = 20;  ///< views placed in between, for two views to close a loop
  std::size_t min_shared = 4;  ///< points of the far view that should be seen from here and are not
  double merge_m = 0.02;       ///< points closer than this are one [P, III-A 3]
  double overlap_m = 0.05;     ///< rings cannot overlap: of two points closer than this, one is a misread ring
};

/// Loop closure by co-visibility [P, III-A 2]: where the map says that a view should see points which only far-away
/// views measured, the view is matched (Algorithm 1) with the far view that shares most of them, and points that turn
/// out to be the same become one. @return how many points went.
std::size_t close_loops(const Survey& survey, const std::vector<std::vector<StereoPoint>>& stereo,
                        const TrackOptions& track, const LoopOptions& options, Reconstruction& map);

/// Joins points that are closer than merge_m. Where both were measured in one image (a ring that was detected twice),
/// the weaker point's sighting is released. Of two points closer than overlap_m, one measured three times as often as
/// the other, the rarer goes. @return how many points went.
std::size_t merge_close_points(Reconstruction& map, const LoopOptions& options);

/// Moves `other` into `map` if triangles show where it lies; `other` is empty then.
/// @return false, nothing changed, if they share too little or the place is not unique.
bool join_maps(const TrackOptions& options, Reconstruction& map, Reconstruction& other);

}  // namespace roomcal::tools
