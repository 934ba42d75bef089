#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tools/simulate/echo.h"

namespace roomcal::tools {

/// One laser at the moment when it fires, in the LiDAR's frame.
struct Firing {
  Vec3 origin_lidar = Vec3::Zero();
  Vec3 direction_lidar = Vec3::UnitX();  ///< unit
  std::size_t beam = 0;
};

/// A spinning LiDAR: when and where it fires, and the packets that tell of it.
class LidarUnit {
 public:
  virtual ~LidarUnit() = default;

  virtual std::size_t beams() const = 0;
  /// Typical noise of one range.
  virtual double sigma_m() const = 0;
  /// Firings of so many whole turns and a rest that fills packets: a recording begins and ends anywhere.
  virtual std::size_t firings(int turns) const = 0;
  virtual Firing firing(std::size_t index) const = 0;
  /// @param echoes  of firings 0, 1, ...; as many as whole packets hold
  /// @return bytes of a pcap file whose arrival stamps begin at kRecordingStart_ns
  virtual std::vector<std::byte> pcap(std::span<const Echo> echoes) const = 0;
};

/// When simulated recordings begin, realtime clock.
inline constexpr int64_t kRecordingStart_ns = 1'700'000'000'000'000'000;

/// @param kind  as in device.yaml. @param seed  draws where its turn begins
/// @throws ToolError for a kind that has no simulated packets.
std::unique_ptr<LidarUnit> make_lidar_unit(const std::string& kind, uint64_t seed);

}  // namespace roomcal::tools
