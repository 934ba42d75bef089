#pragma once

#include <vector>

#include "tools/bake/reconstruction.h"
#include "tools/bake/stereo_match.h"

namespace roomcal::tools {

/// Refuses what no reconstruction can mend, before it is tried.
/// @throws ToolError: no markers at all; left and right exchanged; a calibration that leaves most sightings without a
///         partner.
void check_stereo(const Survey& survey, const StereoRig& rig, const std::vector<std::vector<StereoPoint>>& stereo,
                  const StereoMatchOptions& options);

/// @param maps  what tracking could not join, most views first.
/// @throws ToolError if the second map is too large to be a few lost views: two rooms.
void check_one_room(const Survey& survey, const std::vector<Reconstruction>& maps);

/// "000012, 000013 and 5 more".
std::string name_views(const Survey& survey, const std::vector<std::size_t>& views, std::size_t at_most = 8);

}  // namespace roomcal::tools
