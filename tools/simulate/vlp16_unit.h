#pragma once

#include "runtime/lidar/calibration.h"
#include "tools/simulate/lidar_unit.h"
#include "tools/simulate/vlp16_packets.h"

namespace roomcal::tools {

/// Velodyne VLP-16 at 10 turns a second, strongest return; vertical offsets of the lasers are zero.
class Vlp16Unit final : public LidarUnit {
 public:
  /// @param first_turn  see make_lidar_unit()
  explicit Vlp16Unit(double first_turn);

  std::string model() const override { return "vlp16"; }
  std::size_t beams() const override { return kVlp16Lasers; }
  RangeSpread spread() const override { return {0.015, 0.005}; }
  std::size_t firings(int turns) const override;
  Firing firing(std::size_t index) const override;
  std::vector<std::byte> pcap(std::span<const Echo> echoes) const override;

 private:
  Vlp16Stream stream_;
  lidar::Calibration calibration_;
};

}  // namespace roomcal::tools
