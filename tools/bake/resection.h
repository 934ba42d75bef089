#pragma once

#include "tools/bake/reconstruction.h"

namespace roomcal::tools {

/// How well a view hangs in the map.
struct ViewFit {
  std::size_t sightings = 0;  ///< measurements with a point
  std::size_t in_both = 0;    ///< points measured left and right
  std::size_t expected = 0;   ///< points of the map that should be well inside the left image
  std::size_t met = 0;        ///< of these, how many were measured there
  double rms_px = 0;          ///< per measurement (both axes)
};

/// Gives each sighting of a view the map point that projects nearest to it within the gate, one to one in each image.
/// The gate widens by what the point's own covariance projects to. Old assignments of the view are dropped.
/// @param spread_px  how far off the pose may make projections.
void assign_points(const Survey& survey, Reconstruction& map, std::size_t view, double sigma_px, double spread_px);

/// Pose of a view from its assigned sightings in both images: robust Gauss-Newton, points weighed by their covariance.
/// @return false, pose unchanged, for fewer than three sightings. Cost: ten rounds.
bool resect(const Survey& survey, Reconstruction& map, std::size_t view, double sigma_px);

ViewFit judge_view(const Survey& survey, const Reconstruction& map, std::size_t view);

}  // namespace roomcal::tools
