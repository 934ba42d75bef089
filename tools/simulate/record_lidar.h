#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/simulate/echo.h"
#include "tools/simulate/stand.h"

namespace roomcal::tools {

/// One file of a shot's folder.
struct ShotFile {
  std::string name;
  std::vector<std::byte> bytes;
};

/// What a LiDAR leaves in a shot's folder.
struct LidarRecording {
  std::vector<ShotFile> files;  ///< the sweeps first, as file_of() names them; then what their reader wants beside
  std::size_t firings = 0, returns = 0;
};

/// "lidar0.pcap", or pcd for a TLS.
std::string file_of(const TrueLidar& lidar);

/// Cost: about 1 us a firing, on all cores.
/// @param seed  other seed, other noise and another begin of the recording
LidarRecording record_lidar(const EchoCaster& caster, const TrueLidar& lidar, const LidarOptions& options,
                            uint64_t seed);

}  // namespace roomcal::tools
