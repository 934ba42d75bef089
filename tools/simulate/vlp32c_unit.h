#pragma once

#include "runtime/lidar/calibration.h"
#include "tools/simulate/lidar_unit.h"

namespace roomcal::tools {

/// Velodyne VLP-32C at 10 turns a second, strongest return, with the manual's angles: a block is one firing of 32
/// lasers, two at once; ranges in steps of 4 mm. Source: VLP-32C User Manual 63-9325, "Firing sequence", "Packet
/// structure".
class Vlp32cUnit final : public LidarUnit {
 public:
  explicit Vlp32cUnit(double first_turn);

  std::string model() const override { return "vlp32c"; }
  std::size_t beams() const override { return kLasers; }
  RangeSpread spread() const override { return {0.015, 0.005}; }
  std::size_t firings(int turns) const override;
  Firing firing(std::size_t index) const override;
  std::vector<std::byte> pcap(std::span<const Echo> echoes) const override;

 private:
  static constexpr std::size_t kLasers = 32;

  /// Of the head, not wrapped.
  double azimuth_rad(double time_us) const;

  double first_azimuth_rad_;
  lidar::Calibration calibration_;
};

}  // namespace roomcal::tools
