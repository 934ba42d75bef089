#pragma once

#include <vector>

#include "tools/bake/survey.h"

namespace roomcal::tools {

struct StereoMatchOptions {
  double sigma_px = 1.0;     ///< what a centre may be off by, calibration errors included; gates are multiples of it
  double gate_sigmas = 3.0;  ///< of the distance from the epipolar line
  double min_range_m = 0.15;
  double max_range_m = 20;
  double max_size_ratio = 1.25;  ///< between the two images of a marker, where ellipses are known
};

/// A left and a right sighting that may be the same marker.
struct StereoPoint {
  std::size_t left = 0, right = 0;  ///< numbers in StereoView::seen
  Vec3 p_left = Vec3::Zero();       ///< triangulated, left camera's frame
  Mat33 cov_m2 = Mat33::Zero();     ///< of p_left, for sigma_px
  double residual_px = 0;           ///< root of the sum of squares, four coordinates
  bool ambiguous = false;           ///< one of its sightings is in another point too
};

/// Pairs the sightings of one stop by epipolar search and triangulates them [P, III-A].
///
/// A sighting with several partners on its epipolar line gives several points: which of them is true shows only when
/// the stop is matched with others.
/// Cost: left x right epipolar distances.
std::vector<StereoPoint> match_stereo(const StereoRig& rig, const StereoView& view, const StereoMatchOptions& options);

/// Noise of a centre per axis as the distances from the epipolar lines show it: a stereo point's four residuals have
/// one degree of freedom. Robust (median); points with a choice of partners are not asked.
double epipolar_sigma_px(const std::vector<std::vector<StereoPoint>>& stereo);

}  // namespace roomcal::tools
