#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/simulate/echo.h"
#include "tools/simulate/stand.h"

namespace roomcal::tools {

/// What a LiDAR leaves in a shot's folder.
struct LidarRecording {
  std::string file;              ///< its name there
  std::vector<std::byte> bytes;  ///< and what it holds
  std::size_t firings = 0, returns = 0;
};

/// "lidar0.pcap", or pcd for a TLS.
std::string file_of(const TrueLidar& lidar);

/// Cost: about 2 us a firing, on all cores.
LidarRecording record_lidar(const EchoCaster& caster, const TrueLidar& lidar, const LidarOptions& options,
                            uint64_t seed);

}  // namespace roomcal::tools
