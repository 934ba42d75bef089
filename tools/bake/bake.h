#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/bake/quality.h"
#include "tools/bake/reconstruct.h"
#include "tools/bake/room_axes.h"
#include "tools/bake/scale.h"
#include "tools/map/map_data.h"
#include "tools/map/map_quality.h"

namespace roomcal::tools {

struct BakeOptions {
  ReconstructOptions reconstruct;
  std::filesystem::path distances;  ///< hand-measured distances; empty: none
  double marker_radius_m = 0;       ///< as printed; 0: not known
};

/// A baked room and everything that can be said about it.
struct BakeResult {
  MapData data;        ///< ready for build_map(); id and time are the caller's
  Reconstruction map;  ///< in the room's frame and scale
  ReconstructSummary summary;
  RoomAxes axes;
  ScaleReport scale;
  std::vector<MarkerQuality> quality;  ///< one for each of data.markers
  MapQuality map_quality;              ///< what a device will find; its advice has the survey's in front
  std::array<double, 2> median_px{};   ///< length of the residuals, left and right
  std::array<double, 2> rms_px{};
};

/// Bakes a room: correspondence, tracking, loop closure, merging, adjustment [P, III-A], then covariance, normals and
/// radii, scale, room axes, planes and quality.
/// @throws ToolError for a survey that cannot become a map, naming the reason and the remedy.
BakeResult bake(const Survey& survey, const StereoRig& rig, const BakeOptions& options);

}  // namespace roomcal::tools
