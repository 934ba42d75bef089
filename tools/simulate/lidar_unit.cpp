#include "tools/simulate/lidar_unit.h"

#include "tools/common/error.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/vlp16_unit.h"

namespace roomcal::tools {

std::unique_ptr<LidarUnit> make_lidar_unit(const std::string& kind, uint64_t seed) {
  Random random = random_stream(seed, 1u << 30);
  const double first_azimuth_rad = random.uniform(0, 2 * kPi);
  if (kind == "vlp16") return std::make_unique<Vlp16Unit>(first_azimuth_rad);
  throw ToolError("LiDAR " + kind + ": has no simulated packets; take vlp16");
}

}  // namespace roomcal::tools
