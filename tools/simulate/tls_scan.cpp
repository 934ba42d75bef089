#include "tools/simulate/tls_scan.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "runtime/lidar/r2000.h"
#include "tools/simulate/lidar_unit.h"
#include "tools/simulate/packet_buffer.h"
#include "tools/simulate/pcap_writer.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/raster.h"

namespace roomcal::tools {

namespace {

constexpr double kDivergence_rad = 0.001;

lidar::SweepPoint point_of(const Echo& echo, const Vec3& direction_lidar) {
  const Vec3 p_lidar = echo.range_m * direction_lidar;
  lidar::SweepPoint point;
  point.x_m = static_cast<float>(p_lidar.x());
  point.y_m = static_cast<float>(p_lidar.y());
  point.z_m = static_cast<float>(p_lidar.z());
  point.range_m = static_cast<float>(echo.range_m);
  point.reflectivity = static_cast<uint16_t>(std::lround(echo.reflectivity_percent));
  return point;
}

constexpr int64_t kProfile_ns = 20'000'000;
constexpr int kTurn_1e4deg = 3'600'000;
constexpr int kRaysPerPacket = 340;  // of 4 bytes: below the network's 1500
constexpr uint32_t kNoEcho = 0xFFFFF;
constexpr uint16_t kPort = 6464;

int64_t profile_ns(int profile) { return kRecordingStart_ns + kProfile_ns * profile; }

struct R2000Place {
  int rays, profile, first, count;
  uint32_t packet;
};

/// "R2000 Ethernet communication protocol" (PFSDP), chapter "Scan data output", basic header.
void put_r2000_head(PacketBuffer& packet, const R2000Place& place, int64_t stamp_ns) {
  const auto seconds = static_cast<uint64_t>(stamp_ns / 1'000'000'000);
  const auto rest_ns = static_cast<uint64_t>(stamp_ns % 1'000'000'000);
  packet.le(0, 0xA25C, 2);
  packet.le(2, 'C', 2);
  packet.le(4, packet.view().size(), 4);
  packet.le(8, lidar::kR2000HeadBytes, 2);
  packet.le(10, static_cast<uint64_t>(place.profile), 2);
  packet.le(12, place.packet, 2);
  packet.le(14, seconds << 32 | (rest_ns << 32) / 1'000'000'000, 8);
  packet.le(34, 50'000, 4);  // mHz
  packet.le(38, static_cast<uint64_t>(place.rays), 2);
  packet.le(40, static_cast<uint64_t>(place.count), 2);
  packet.le(42, static_cast<uint64_t>(place.first), 2);
  packet.le(44, static_cast<uint64_t>(kTurn_1e4deg / place.rays * place.first), 4);
  packet.le(48, static_cast<uint64_t>(kTurn_1e4deg / place.rays), 4);
}

}  // namespace

Vec3 tls_direction_lidar(double servo_rad, double profile_rad) {
  const double level = std::cos(profile_rad);
  return {level * std::sin(servo_rad), -std::sin(profile_rad), level * std::cos(servo_rad)};
}

SphereScan scan_sphere(const EchoCaster& caster, const SE3& T_room_lidar, double step_rad, const RangeFlaws& flaws,
                       double offset_m, uint64_t seed) {
  int rays = 2 * static_cast<int>(std::ceil(kPi / step_rad));
  while (kTurn_1e4deg % rays != 0) rays += 2;
  SphereScan scan{rays / 2, rays, {}};
  scan.echoes.resize(static_cast<std::size_t>(scan.profiles) * static_cast<std::size_t>(scan.rays));
  parallel_for(scan.profiles, [&](int i) {
    Random random = random_stream(seed, static_cast<uint64_t>(i));
    for (int k = 0; k < scan.rays; ++k) {
      const Vec3 along = tls_direction_lidar(scan.servo_rad(i), scan.profile_rad(k));
      const Pulse pulse{T_room_lidar.t, T_room_lidar.R * along, kDivergence_rad, offset_m};
      scan.echoes[static_cast<std::size_t>(i * scan.rays + k)] = caster.echo(pulse, flaws, random);
    }
  });
  return scan;
}

LoadedSweep cloud_of(const SphereScan& scan) {
  LoadedSweep sweep;
  sweep.facts.beam_count = 1;
  for (int i = 0; i < scan.profiles; ++i) {
    for (int k = 0; k < scan.rays; ++k) {
      if (scan.at(i, k).range_m == 0) continue;
      sweep.points.push_back(point_of(scan.at(i, k), tls_direction_lidar(scan.servo_rad(i), scan.profile_rad(k))));
    }
  }
  return sweep;
}

std::vector<std::byte> profiles_pcap(const SphereScan& scan) {
  PcapWriter writer;
  uint32_t number = 0;
  for (int profile = 0; profile < scan.profiles; ++profile) {
    for (int first = 0; first < scan.rays; first += kRaysPerPacket) {
      const int count = std::min(kRaysPerPacket, scan.rays - first);
      PacketBuffer packet(lidar::kR2000HeadBytes + 4 * static_cast<std::size_t>(count));
      const int64_t stamp_ns = profile_ns(profile) + kProfile_ns * first / scan.rays;
      put_r2000_head(packet, {scan.rays, profile, first, count, number++}, stamp_ns);
      for (int i = 0; i < count; ++i) {
        const Echo& echo = scan.at(profile, first + i);
        const uint32_t range_mm = range_count(echo.range_m, 0.001, kNoEcho - 1);
        const auto amplitude = static_cast<uint32_t>(std::lround(10 * echo.reflectivity_percent));
        packet.le(lidar::kR2000HeadBytes + 4 * static_cast<std::size_t>(i),
                  range_mm == 0 ? kNoEcho : range_mm | amplitude << 20, 4);
      }
      writer.add(packet.view(), stamp_ns + kProfile_ns * count / scan.rays, kPort);
    }
  }
  return writer.bytes();
}

std::string servo_csv(const SphereScan& scan) {
  std::string csv = "stamp_ns,angle_rad\n";
  for (int i = 0; i < scan.profiles; ++i) csv += fmt::format("{},{:.9f}\n", profile_ns(i), scan.servo_rad(i));
  return csv;
}

}  // namespace roomcal::tools
