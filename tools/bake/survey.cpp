#include "tools/bake/survey.h"

#include <algorithm>
#include <cmath>

namespace roomcal::tools {

void normalize_covariances(Survey& survey) {
  std::vector<double> variances;
  const auto for_each = [&](const auto& work) {
    for (StereoView& view : survey.views) {
      for (std::vector<Sighting>& seen : view.seen) {
        for (Sighting& sighting : seen) work(sighting);
      }
    }
  };
  for_each([&](const Sighting& sighting) { variances.push_back(0.5 * sighting.cov_px2.trace()); });
  if (variances.empty()) return;
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  constexpr double kMostVariance = 9;
  for_each([&](Sighting& sighting) {
    sighting.cov_px2 /= *middle;
    const double size = 0.5 * sighting.cov_px2.trace();
    sighting.cov_px2 *= std::clamp(size, 1 / kMostVariance, kMostVariance) / size;
    // Needles: a direction is never ten times better than the other.
    sighting.cov_px2 += 0.01 * sighting.cov_px2.trace() * Mat22::Identity();
  });
}

}  // namespace roomcal::tools
