#include "tools/map/noise.h"

#include <fmt/format.h>

#include "tools/common/random.h"
#include "tools/map/plane_refit.h"

namespace roomcal::tools {

void add_noise(MapData& data, double sigma_m, uint64_t seed, bool declare) {
  Random random(seed);
  for (map::MapMarker& marker : data.markers) {
    for (int axis = 0; axis < 3; ++axis) marker.p_room[axis] += sigma_m * random.normal();
    if (declare) marker.cov_m2 += sigma_m * sigma_m * Mat33::Identity();
  }
  if (sigma_m > 0) refit_planes(data);
  data.id += fmt::format("+noise{}mm", sigma_m * 1e3);
  data.provenance += fmt::format("; noise sigma {} m seed {}{}", sigma_m, seed, declare ? "" : " (not declared)");
}

}  // namespace roomcal::tools
