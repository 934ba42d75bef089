#include "tools/simulate/vlp16_unit.h"

#include <cmath>

namespace roomcal::tools {

namespace {
constexpr int64_t kHour_ns = 3'600'000'000'000;
}

Vlp16Unit::Vlp16Unit(double first_turn) : calibration_(lidar::built_in_calibration(lidar::Model::kVlp16).value()) {
  stream_.first_azimuth_rad = 2 * kPi * first_turn;
  stream_.first_ns = kRecordingStart_ns % kHour_ns;
}

std::size_t Vlp16Unit::firings(int turns) const {
  const std::size_t sequences = static_cast<std::size_t>(turns) * (stream_.firings_per_turn() + 1);
  return (sequences / kVlp16FiringsPerPacket + 2) * kVlp16FiringsPerPacket * kVlp16Lasers;
}

Firing Vlp16Unit::firing(std::size_t index) const {
  const std::size_t laser = index % kVlp16Lasers;
  const double azimuth = stream_.azimuth_rad(index / kVlp16Lasers, laser);
  const lidar::Calibration::Trig& trig = calibration_.trig[laser];
  return {Vec3::Zero(),
          {trig.cos_elevation * std::sin(azimuth), trig.cos_elevation * std::cos(azimuth), trig.sin_elevation},
          laser};
}

std::vector<std::byte> Vlp16Unit::pcap(std::span<const Echo> echoes) const {
  std::vector<Vlp16Return> returns;
  returns.reserve(echoes.size());
  for (const Echo& echo : echoes)
    returns.push_back({echo.range_m, static_cast<uint8_t>(std::lround(echo.reflectivity_percent)), 0, 0});
  return make_vlp16_pcap(stream_, returns, kRecordingStart_ns);
}

}  // namespace roomcal::tools
