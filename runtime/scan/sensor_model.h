#pragma once

#include <cstddef>

namespace roomcal::scan {

inline constexpr std::size_t kMaxBeams = 128;

/// What the data sheet says about a LiDAR's ranges. Angles are taken as exact but for `angle_sigma_rad`.
struct SensorModel {
  double sigma_m = 0.015;  ///< of one range; a sweep that scatters more is weighed by what it shows
  /// Sigma of the constant range offsets of single beams, the prior of their estimates; 0: the sensor has none. Real
  /// units show 2 to 15 mm at room range.
  double beam_offset_sigma_m = 0.010;
  double angle_sigma_rad = 0.0003;  ///< of a beam's direction: counts where it grazes a surface
  double min_range_m = 0.3;         ///< shorter returns are the device itself
  double max_range_m = 100;
};

}  // namespace roomcal::scan
