#include "tools/simulate/xt32_unit.h"

#include <chrono>
#include <cmath>

#include <fmt/core.h>

#include "tools/simulate/packet_buffer.h"
#include "tools/simulate/pcap_writer.h"
#include "tools/simulate/random_stream.h"
#include "tools/sweep/calibration_files.h"

namespace roomcal::tools {

namespace {

constexpr int kStep_cdeg = 18, kTurn_cdeg = 36000;  // 0.18 degree in 50 us
constexpr int64_t kBlock_ns = 50'000;
constexpr int64_t kBeforeStamp_ns = 5'632;  // the last block begins so long after the time in the tail
constexpr double kRangeUnit_m = 0.004;
constexpr std::size_t kBlocks = 8, kHeadBytes = 12, kBlockBytes = 2 + 32 * 4,
                      kTailAt = kHeadBytes + kBlocks * kBlockBytes, kPacketBytes = kTailAt + 24 + 4;

std::string draw_angles(uint64_t unit_seed) {
  Random random = random_stream(unit_seed, 32);
  std::string csv = "Channel,Elevation,Azimuth\n";
  for (int laser = 0; laser < 32; ++laser)
    csv += fmt::format("{},{:.6f},{:.6f}\n", laser + 1, 15 - laser + 0.03 * random.normal(),
                       0.08 + 0.005 * random.normal());
  return csv;
}

/// Date and time of day as the tail has them: years since 1900, month, day, hour, minute, second.
void put_utc(PacketBuffer& packet, std::size_t at, int64_t unix_s) {
  using namespace std::chrono;
  const sys_seconds time{seconds(unix_s)};
  const sys_days day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss clock(time - day);
  packet.le(at, static_cast<uint64_t>(static_cast<int>(date.year()) - 1900), 1);
  packet.le(at + 1, static_cast<unsigned>(date.month()), 1);
  packet.le(at + 2, static_cast<unsigned>(date.day()), 1);
  packet.le(at + 3, static_cast<uint64_t>(clock.hours().count()), 1);
  packet.le(at + 4, static_cast<uint64_t>(clock.minutes().count()), 1);
  packet.le(at + 5, static_cast<uint64_t>(clock.seconds().count()), 1);
}

void put_head(PacketBuffer& packet) {
  packet.le(0, 0xFFEE, 2);
  packet.le(2, 6, 1);  // protocol 6.1
  packet.le(3, 1, 1);
  packet.le(6, 32, 1);
  packet.le(7, kBlocks, 1);
  packet.le(9, std::lround(1000 * kRangeUnit_m), 1);
  packet.le(10, 1, 1);  // returns
  packet.le(11, 1, 1);  // with a sequence number
}

void put_tail(PacketBuffer& packet, int64_t stamp_ns, uint32_t sequence) {
  packet.le(kTailAt + 10, 0x37, 1);  // strongest
  packet.le(kTailAt + 11, 600, 2);   // turns a minute
  put_utc(packet, kTailAt + 13, stamp_ns / 1'000'000'000);
  packet.le(kTailAt + 19, static_cast<uint64_t>(stamp_ns / 1000 % 1'000'000), 4);
  packet.le(kTailAt + 23, 0x42, 1);  // Hesai
  packet.le(kTailAt + 24, sequence, 4);
}

}  // namespace

Xt32Unit::Xt32Unit(uint64_t unit_seed, double first_turn)
    : angles_csv_(draw_angles(unit_seed)),
      calibration_(parse_hesai_csv(lidar::Model::kXt32, "simulated", angles_csv_)),
      first_azimuth_cdeg_(static_cast<int>(first_turn * kTurn_cdeg)) {}

std::size_t Xt32Unit::firings(int turns) const {
  const std::size_t blocks = static_cast<std::size_t>(turns) * kTurn_cdeg / kStep_cdeg;
  return (blocks / kBlocks + 1) * kBlocks * kLasers;
}

Firing Xt32Unit::firing(std::size_t index) const {
  const std::size_t laser = index % kLasers;
  const auto block = static_cast<double>(index / kLasers);
  const lidar::Beam& beam = calibration_.beams[laser];
  const double azimuth = deg_to_rad(0.01 * (first_azimuth_cdeg_ + kStep_cdeg * block)) + beam.azimuth_offset_rad;
  const double level = std::cos(beam.elevation_rad);
  return {Vec3::Zero(), {level * std::sin(azimuth), level * std::cos(azimuth), std::sin(beam.elevation_rad)}, laser};
}

std::vector<std::byte> Xt32Unit::pcap(std::span<const Echo> echoes) const {
  PcapWriter writer;
  const std::size_t each = kBlocks * kLasers;
  for (std::size_t first = 0; first + each <= echoes.size(); first += each) {
    PacketBuffer packet(kPacketBytes);
    put_head(packet);
    for (std::size_t block = 0; block < kBlocks; ++block) {
      const std::size_t at = kHeadBytes + block * kBlockBytes, number = first / kLasers + block;
      packet.le(at, (static_cast<std::size_t>(first_azimuth_cdeg_) + number * kStep_cdeg) % kTurn_cdeg, 2);
      for (std::size_t laser = 0; laser < kLasers; ++laser) {
        const Echo& echo = echoes[first + block * kLasers + laser];
        const uint32_t count = range_count(echo.range_m, kRangeUnit_m, 0xFFFF);
        packet.le(at + 2 + 4 * laser, count, 2);
        if (count > 0) packet.le(at + 4 + 4 * laser, static_cast<uint64_t>(std::lround(echo.reflectivity_percent)), 1);
      }
    }
    const int64_t end_ns = kRecordingStart_ns + kBlock_ns * static_cast<int64_t>(first / kLasers + kBlocks);
    put_tail(packet, end_ns - kBlock_ns - kBeforeStamp_ns, static_cast<uint32_t>(first / each));
    writer.add(packet.view(), end_ns, 2368);
  }
  return writer.bytes();
}

}  // namespace roomcal::tools
