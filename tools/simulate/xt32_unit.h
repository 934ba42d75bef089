#pragma once

#include "runtime/lidar/calibration.h"
#include "tools/simulate/lidar_unit.h"

namespace roomcal::tools {

/// Hesai PandarXT-32 at 10 turns a second, strongest return, ranges in steps of 4 mm; its own angles scatter about a
/// degree's spacing and come as the maker's CSV. All 32 lasers of a block count as fired at the block's azimuth, as the
/// maker's own decoder has it (ARCHITECTURE.md). Source: PandarXT user manual, "Point cloud data packet", "Laser firing
/// time".
class Xt32Unit final : public LidarUnit {
 public:
  Xt32Unit(uint64_t unit_seed, double first_turn);

  std::string model() const override { return "xt32"; }
  std::size_t beams() const override { return kLasers; }
  RangeSpread spread() const override { return {0.005, 0.002}; }
  UnitFile unit_file() const override { return {".csv", angles_csv_}; }
  std::size_t firings(int turns) const override;
  Firing firing(std::size_t index) const override;
  std::vector<std::byte> pcap(std::span<const Echo> echoes) const override;

 private:
  static constexpr std::size_t kLasers = 32;

  std::string angles_csv_;
  lidar::Calibration calibration_;
  int first_azimuth_cdeg_;
};

}  // namespace roomcal::tools
