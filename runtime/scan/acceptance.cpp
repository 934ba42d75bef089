#include "runtime/scan/acceptance.h"

#include <algorithm>
#include <cmath>

namespace roomcal::scan {

FitShares shares_of(const RangeSums& sums, const SensorModel& sensor, double sigma_m, const RangeState& state) {
  const double mapped = std::max(1.0, static_cast<double>(sums.mapped));
  FitShares shares;
  shares.mapped = sums.mapped / std::max(1.0, static_cast<double>(sums.valid));
  shares.explained = sums.inliers / mapped;
  shares.beyond = sums.beyond / mapped;
  for (const RangeSums::FaceCount& face : sums.face) {
    if (3 * face.inliers < face.predicted) shares.contradicted += face.predicted / mapped;
  }
  const double squares = sums.inlier_squares / std::max(1.0, static_cast<double>(sums.inliers));
  shares.scatter = std::sqrt(squares) * sigma_m / sensor.sigma_m;
  double offset_squares = 0, beams = 0;
  for (std::size_t k = 0; k < kMaxBeams; ++k) {
    if (sums.beam[k].points == 0 || sensor.beam_offset_sigma_m <= 0) continue;
    offset_squares += state.offset_m[k] * state.offset_m[k];
    ++beams;
  }
  if (beams > 0) shares.offsets = std::sqrt(offset_squares / beams) / sensor.beam_offset_sigma_m;
  return shares;
}

const char* why_refused(const FitShares& shares, const AcceptanceLimits& limits) {
  if (shares.mapped < limits.min_mapped) {
    return "most points see nothing that the map knows: another room, or a map without these walls";
  }
  if (shares.beyond > limits.max_beyond) return "points lie behind the map's walls: another room, or a wrong map";
  if (shares.explained < limits.min_explained) {
    return "too few points lie on the map's planes: another room, or the view is blocked";
  }
  if (shares.contradicted > limits.max_contradicted) {
    return "a wall stands elsewhere than in the map: another room, or a wrong map";
  }
  if (shares.scatter > limits.max_scatter) {
    return "ranges scatter more than the sensor's sigma: another room, or the sigma is too small";
  }
  if (shares.offsets > limits.max_offsets) {
    return "beam offsets are larger than the sensor's: another room, or their sigma is too small";
  }
  return "";
}

}  // namespace roomcal::scan
