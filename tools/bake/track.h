#pragma once

#include <vector>

#include "tools/bake/place_view.h"
#include "tools/bake/reconstruction.h"

namespace roomcal::tools {

/// Triangulated points of every view, computed once.
std::vector<std::vector<StereoPoint>> match_all_stereo(const StereoRig& rig, const Survey& survey,
                                                       const StereoMatchOptions& options);

/// Stereo frame tracking [P, III-A 1]: every view is matched by triangles with what the views before it saw, then with
/// the whole map so far; what it sees for the first time becomes points of the map, and the map is adjusted as it
/// grows. A view that fits nowhere starts a map of its own.
///
/// @return the maps, each in its own frame; the one with most views first. Views are placed in one map at most.
/// Cost: per view one match of small sets, and adjustments whose sizes grow by a quarter: linear in the survey.
std::vector<Reconstruction> track(const Survey& survey, const StereoRig& rig,
                                  const std::vector<std::vector<StereoPoint>>& stereo, const TrackOptions& options);

}  // namespace roomcal::tools
