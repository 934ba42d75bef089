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

/// Typical figures of a kind of LiDAR.
struct RangeSpread {
  double sigma_m = 0;       ///< noise of one range
  double bias_sigma_m = 0;  ///< of what each laser is off by
};

/// What a unit's maker delivers with it, for its decoder; no text: the manual's angles will do.
struct UnitFile {
  std::string extension;  ///< ".csv" or ".json"
  std::string text;
};

/// A spinning LiDAR: when and where it fires, and the packets that tell of it.
class LidarUnit {
 public:
  virtual ~LidarUnit() = default;

  /// As in device.yaml.
  virtual std::string model() const = 0;
  virtual std::size_t beams() const = 0;
  virtual RangeSpread spread() const = 0;
  virtual UnitFile unit_file() const { return {}; }
  /// Firings of so many whole turns and a rest that fills packets: a recording begins and ends anywhere.
  virtual std::size_t firings(int turns) const = 0;
  virtual Firing firing(std::size_t index) const = 0;
  /// @param echoes  of firings 0, 1, ...; as many as whole packets hold
  /// @return bytes of a pcap file whose arrival stamps begin at kRecordingStart_ns
  virtual std::vector<std::byte> pcap(std::span<const Echo> echoes) const = 0;
};

/// When simulated recordings begin, realtime clock.
inline constexpr int64_t kRecordingStart_ns = 1'700'000'000'000'000'000;

/// "vlp16, vlp32c, ..."
std::string lidar_unit_names();

/// @param name        one of lidar_unit_names()
/// @param unit_seed   draws the unit's own angles, where its kind has some
/// @param first_turn  where the recording begins, as a share of the turn: [0, 1)
/// @throws ToolError that lists the names.
std::unique_ptr<LidarUnit> make_lidar_unit(const std::string& name, uint64_t unit_seed, double first_turn);

}  // namespace roomcal::tools
