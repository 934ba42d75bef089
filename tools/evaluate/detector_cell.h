#pragma once

#include <vector>

#include "runtime/base/arena.h"
#include "tools/simulate/marker_field.h"

namespace roomcal::tools {

/// One combination of the sweep.
struct CellSpec {
  double diameter_px = 40;
  double slant_deg = 0;
  double gradient = 0;  ///< along +x, over one diameter
  double noise_sigma = 2;
  bool fisheye = false;
  RingRadii ring_radii = kBestRings;
};

/// What the detector did with the markers of one combination. Sums, so that cells can be pooled.
struct CellResult {
  CellSpec spec;
  int truths = 0;
  int found = 0;
  int false_alarms = 0;   ///< status ok and no marker there, or a second one at the same marker
  int over_capacity = 0;  ///< images in which the detector said that its tables were full
  Vec2 sum_error_px = Vec2::Zero();
  Mat22 sum_error_error_px2 = Mat22::Zero();
  double sum_nees = 0;        ///< of the reported covariances; 2 per marker is honest
  double bound_px2 = 0;       ///< mean trace of the Cramer-Rao bound at this noise
  double bound_full_px2 = 0;  ///< the same with unknown radii and blur
  double detect_ms = 0;       ///< all images
  double megapixels = 0;      ///< all images

  double recall() const { return truths > 0 ? static_cast<double>(found) / truths : 0; }
  /// Root of the mean squared distance from the truth, both axes together.
  double rms_px() const;
  Vec2 mean_error_px() const { return sum_error_px / std::max(1, found); }
  /// Standard error of the mean, larger axis.
  double mean_error_sigma_px() const;
  double nees_half() const { return sum_nees / (2 * std::max(1, found)); }
  double bound_rms_px() const;
  double ratio() const { return rms_px() / bound_rms_px(); }
};

/// Time of the detector on an image without a marker, ms per megapixel. The best of several runs.
double empty_image_ms_per_mp(std::vector<std::byte>& scratch);

/// The sum of several cells' counts and errors; spec and bound are the first one's.
CellResult pool(const std::vector<CellResult>& cells);

/// Markers of one size, slant and light; noise is added to the same rendering for each of `noises`.
/// @param target_markers  as many images are made as it takes
/// @param scratch  for the detector
/// @throws ToolError if the detector refuses.
std::vector<CellResult> run_cells(const CellSpec& spec, const std::vector<double>& noises, int target_markers,
                                  std::vector<std::byte>& scratch);

}  // namespace roomcal::tools
