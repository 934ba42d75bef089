#pragma once

#include <array>

#include "runtime/lidar/calibration.h"
#include "tools/simulate/lidar_unit.h"

namespace roomcal::tools {

/// A kind of Ouster: how its beams leave it, and how its packets are laid out.
struct OusterKind {
  const char* product;
  int rows;
  double top_deg;                     ///< elevation of the first beam; the last one's is the opposite
  std::array<double, 4> azimuth_deg;  ///< of four beams in turn
  double beam_origin_mm;              ///< from the axis to where beams start
  lidar::OusterProfile profile;
};

/// 32 beams over 90 degrees, legacy packets.
inline constexpr OusterKind kOs0_32{
    "OS-0-32", 32, 43.88, {-2.9, -2.8, -2.7, -2.6}, 27.67, lidar::OusterProfile::kLegacy};
/// 64 beams over 42 degrees, staggered over four columns of pixels; RNG19_RFL8_SIG16_NIR16.
inline constexpr OusterKind kOs1_64{
    "OS-1-64", 64, 20.95, {4.21, 1.41, -1.4, -4.22}, 15.806, lidar::OusterProfile::kSingle19};

/// An Ouster in mode 1024x10. Its ranges count from the axis (distance from the beam's origin plus the origin's own),
/// in millimetres. Source: Ouster firmware user manual, "Lidar data packet format", "Lidar range to XYZ".
class OusterUnit final : public LidarUnit {
 public:
  OusterUnit(const OusterKind& kind, uint64_t unit_seed, double first_turn);

  std::string model() const override { return "ouster"; }
  std::size_t beams() const override { return calibration_.beam_count; }
  RangeSpread spread() const override { return {0.010, 0.005}; }
  UnitFile unit_file() const override { return {".json", metadata_}; }
  std::size_t firings(int turns) const override;
  Firing firing(std::size_t index) const override;
  std::vector<std::byte> pcap(std::span<const Echo> echoes) const override;

 private:
  std::string metadata_;
  lidar::Calibration calibration_;
  std::size_t first_column_;  ///< of the recording; a multiple of a packet's
};

}  // namespace roomcal::tools
