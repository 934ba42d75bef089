#include "tools/simulate/vlp32c_unit.h"

#include <cmath>

#include "runtime/lidar/velodyne.h"
#include "tools/simulate/packet_buffer.h"
#include "tools/simulate/pcap_writer.h"

namespace roomcal::tools {

namespace {

constexpr double kBlock_us = 55.296, kPair_us = 2.304, kTurn_us = 100'000, kRangeUnit_m = 0.004;
constexpr std::size_t kBlocks = 12, kBlockBytes = 100, kStampAt = 1200, kModeAt = 1204, kProductAt = 1205;
constexpr uint8_t kProduct = 0x28;
constexpr int64_t kHour_us = 3'600'000'000;

uint64_t azimuth_cdeg(double azimuth_rad) {
  const double cdeg = std::round(rad_to_deg(azimuth_rad) * 100);
  return static_cast<uint64_t>(cdeg - 36000 * std::floor(cdeg / 36000));
}

}  // namespace

Vlp32cUnit::Vlp32cUnit(double first_turn)
    : first_azimuth_rad_(2 * kPi * first_turn),
      calibration_(lidar::built_in_calibration(lidar::Model::kVlp32c).value()) {}

double Vlp32cUnit::azimuth_rad(double time_us) const { return first_azimuth_rad_ + 2 * kPi * time_us / kTurn_us; }

std::size_t Vlp32cUnit::firings(int turns) const {
  const auto blocks = static_cast<std::size_t>(std::ceil(turns * kTurn_us / kBlock_us));
  return (blocks / kBlocks + 2) * kBlocks * kLasers;
}

Firing Vlp32cUnit::firing(std::size_t index) const {
  const std::size_t laser = index % kLasers;
  const double time_us = kBlock_us * static_cast<double>(index / kLasers) + kPair_us * static_cast<double>(laser / 2);
  const lidar::Beam& beam = calibration_.beams[laser];
  const double azimuth = azimuth_rad(time_us) + beam.azimuth_offset_rad, level = std::cos(beam.elevation_rad);
  return {Vec3::Zero(), {level * std::sin(azimuth), level * std::cos(azimuth), std::sin(beam.elevation_rad)}, laser};
}

std::vector<std::byte> Vlp32cUnit::pcap(std::span<const Echo> echoes) const {
  PcapWriter writer;
  for (std::size_t first = 0; first + kBlocks * kLasers <= echoes.size(); first += kBlocks * kLasers) {
    PacketBuffer packet(lidar::kVelodynePacketBytes);
    const double first_us = kBlock_us * static_cast<double>(first / kLasers);
    for (std::size_t block = 0; block < kBlocks; ++block) {
      const std::size_t at = block * kBlockBytes;
      packet.le(at, 0xEEFF, 2);
      packet.le(at + 2, azimuth_cdeg(azimuth_rad(first_us + kBlock_us * static_cast<double>(block))), 2);
      for (std::size_t laser = 0; laser < kLasers; ++laser) {
        const Echo& echo = echoes[first + block * kLasers + laser];
        const uint32_t count = range_count(echo.range_m, kRangeUnit_m, 0xFFFF);
        packet.le(at + 4 + 3 * laser, count, 2);
        if (count > 0) packet.le(at + 6 + 3 * laser, static_cast<uint64_t>(std::lround(echo.reflectivity_percent)), 1);
      }
    }
    const int64_t start_us = kRecordingStart_ns / 1000;
    packet.le(kStampAt, static_cast<uint64_t>((start_us + std::llround(first_us)) % kHour_us), 4);
    packet.le(kModeAt, lidar::kVelodyneStrongest, 1);
    packet.le(kProductAt, kProduct, 1);
    writer.add(packet.view(), kRecordingStart_ns + std::llround(1000 * (first_us + kBlock_us * kBlocks)), 2368);
  }
  return writer.bytes();
}

}  // namespace roomcal::tools
