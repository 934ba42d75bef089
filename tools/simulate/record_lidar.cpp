#include "tools/simulate/record_lidar.h"

#include <algorithm>
#include <cmath>

#include "tools/simulate/lidar_unit.h"
#include "tools/simulate/random_stream.h"
#include "tools/simulate/raster.h"
#include "tools/simulate/tls_scan.h"
#include "tools/sweep/cloud_files.h"

namespace roomcal::tools {

namespace {

constexpr uint64_t kBeginStream = 1U << 30;  // beyond all chunks

RangeFlaws flaws_of(const TrueLidar& lidar, const LidarOptions& options) {
  RangeFlaws flaws;
  flaws.sigma_m = lidar.sigma_m;
  flaws.dropout = options.dropout;
  flaws.mixed_pixels = options.mixed_pixels;
  return flaws;
}

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

std::size_t returns_in(const std::vector<Echo>& echoes) {
  return static_cast<std::size_t>(
      std::count_if(echoes.begin(), echoes.end(), [](const Echo& echo) { return echo.range_m > 0; }));
}

LidarRecording record_tls(const EchoCaster& caster, const TrueLidar& lidar, const LidarOptions& options,
                          uint64_t seed) {
  const SphereScan scan = scan_sphere(caster, lidar.T_room_lidar, options.tls_step_rad, flaws_of(lidar, options),
                                      lidar.beam_offset_m.at(0), seed);
  const LoadedSweep cloud = cloud_of(scan);
  LidarRecording recording{{{file_of(lidar), write_pcd({&cloud, 1})}}, scan.echoes.size(), returns_in(scan.echoes)};
  if (options.tls_profiles) {
    recording.files.push_back({lidar.name + "_profiles.pcap", profiles_pcap(scan)});
    recording.files.push_back({lidar.name + "_servo.csv", bytes_of(servo_csv(scan))});
  }
  return recording;
}

std::vector<Echo> cast_firings(const EchoCaster& caster, const TrueLidar& lidar, const LidarUnit& unit,
                               const LidarOptions& options, uint64_t seed) {
  constexpr std::size_t kChunk = 1024;  // one stream of random numbers each
  const RangeFlaws flaws = flaws_of(lidar, options);
  std::vector<Echo> echoes(unit.firings(options.sweeps));
  parallel_for(static_cast<int>((echoes.size() + kChunk - 1) / kChunk), [&](int chunk) {
    Random random = random_stream(seed, static_cast<uint64_t>(chunk));
    const std::size_t begin = static_cast<std::size_t>(chunk) * kChunk;
    for (std::size_t i = begin; i < std::min(begin + kChunk, echoes.size()); ++i) {
      const Firing firing = unit.firing(i);
      Pulse pulse;
      pulse.origin_room = lidar.T_room_lidar * firing.origin_lidar;
      pulse.direction_room = lidar.T_room_lidar.R * firing.direction_lidar;
      pulse.offset_m = lidar.beam_offset_m.at(firing.beam);
      const double turn = std::atan2(firing.direction_lidar.x(), firing.direction_lidar.y());
      const double azimuth_rad = turn < 0 ? turn + 2 * kPi : turn;
      pulse.blocked = azimuth_rad >= options.blocked_from_rad && azimuth_rad < options.blocked_to_rad;
      echoes[i] = caster.echo(pulse, flaws, random);
    }
  });
  return echoes;
}

}  // namespace

std::string file_of(const TrueLidar& lidar) { return lidar.name + (lidar.unit == kTlsKind ? ".pcd" : ".pcap"); }

LidarRecording record_lidar(const EchoCaster& caster, const TrueLidar& lidar, const LidarOptions& options,
                            uint64_t seed) {
  if (lidar.unit == kTlsKind) return record_tls(caster, lidar, options, seed);
  const double first_turn = random_stream(seed, kBeginStream).uniform();
  const std::unique_ptr<LidarUnit> unit = make_lidar_unit(lidar.unit, lidar.unit_seed, first_turn);
  const std::vector<Echo> echoes = cast_firings(caster, lidar, *unit, options, seed);
  LidarRecording recording{{{file_of(lidar), unit->pcap(echoes)}}, echoes.size(), returns_in(echoes)};
  const UnitFile unit_file = unit->unit_file();
  if (!unit_file.text.empty()) recording.files.push_back({lidar.name + unit_file.extension, bytes_of(unit_file.text)});
  return recording;
}

}  // namespace roomcal::tools
