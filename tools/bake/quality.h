#pragma once

#include <vector>

#include "tools/bake/bundle.h"

namespace roomcal::tools {

/// How well one marker is known.
struct MarkerQuality {
  std::size_t point = 0;      ///< number in Reconstruction::points
  std::size_t views = 0;      ///< stops that measured it
  std::size_t sightings = 0;  ///< images that measured it
  double rms_px = 0;          ///< of its residuals (both axes)
  double expected_m = 0;      ///< root of the covariance's trace
  double held_out_m = -1;  ///< half the distance between where two halves of the survey put it; -1: one half lacks it
};

/// The survey is cut into two halves (every other view) and each is adjusted alone; after alignment a marker's two
/// places differ by about twice the whole map's error. What the covariance promises, measured.
/// @param covariances  from map_covariance().
/// @return one entry for each alive point, in their order. Cost: two adjustments of half size.
std::vector<MarkerQuality> measure_quality(const Survey& survey, const Reconstruction& map,
                                           const std::vector<Mat33>& covariances, const BundleOptions& options);

}  // namespace roomcal::tools
