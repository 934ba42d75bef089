#include "tools/simulate/ouster_unit.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "runtime/lidar/ouster.h"
#include "runtime/math/se3.h"
#include "tools/simulate/packet_buffer.h"
#include "tools/simulate/pcap_writer.h"
#include "tools/simulate/random_stream.h"
#include "tools/sweep/calibration_files.h"

namespace roomcal::tools {

using lidar::OusterProfile;
using nlohmann::json;

namespace {

constexpr std::size_t kColumns = 1024, kPerPacket = 16;
constexpr int64_t kTurn_ns = 100'000'000;
constexpr uint32_t kTicks = 90112;  // of the encoder, a turn
constexpr uint64_t kSerial = 122200000001;

double rounded(double value) { return std::round(100 * value) / 100; }

json metadata(const OusterKind& kind, uint64_t unit_seed) {
  Random random = random_stream(unit_seed, 64);
  json altitude = json::array(), azimuth = json::array(), shift = json::array();
  for (int row = 0; row < kind.rows; ++row) {
    const double even = kind.top_deg * (1 - 2.0 * row / (kind.rows - 1));
    const double turned = rounded(kind.azimuth_deg[static_cast<std::size_t>(row % 4)] + 0.01 * random.normal());
    altitude.push_back(rounded(even + 0.03 * random.normal()));
    azimuth.push_back(turned);
    shift.push_back(std::lround((turned - kind.azimuth_deg[3]) / 360 * kColumns));
  }
  const bool legacy = kind.profile == OusterProfile::kLegacy;
  return {{"prod_line", kind.product},
          {"prod_sn", std::to_string(kSerial)},
          {"lidar_mode", "1024x10"},
          {"beam_altitude_angles", altitude},
          {"beam_azimuth_angles", azimuth},
          {"lidar_origin_to_beam_origin_mm", kind.beam_origin_mm},
          {"lidar_to_sensor_transform", {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36.18, 0, 0, 0, 1}},
          {"udp_port_lidar", 7502},
          {"data_format",
           {{"columns_per_frame", kColumns},
            {"columns_per_packet", kPerPacket},
            {"column_window", {0, kColumns - 1}},
            {"pixels_per_column", kind.rows},
            {"pixel_shift_by_row", shift},
            {"udp_profile_lidar", legacy ? "LEGACY" : "RNG19_RFL8_SIG16_NIR16"}}}};
}

/// Time since the recording's first turn began.
int64_t column_ns(std::size_t column) {
  return static_cast<int64_t>(column) * kTurn_ns / static_cast<int64_t>(kColumns);
}

struct Column {
  std::size_t number = 0;  ///< since the first turn began
  std::span<const Echo> echoes;

  uint64_t stamp_ns() const { return static_cast<uint64_t>(kRecordingStart_ns + column_ns(number)); }
  uint64_t id() const { return number % kColumns; }
  uint64_t frame() const { return number / kColumns; }
};

uint64_t range_mm(const Echo& echo, double origin_m) {
  return echo.range_m > 0 ? range_count(echo.range_m + origin_m, 0.001, 0x7FFFF) : 0;
}

void put_legacy_column(PacketBuffer& packet, std::size_t at, const Column& column, double origin_m) {
  packet.le(at, column.stamp_ns(), 8);
  packet.le(at + 8, column.id(), 2);
  packet.le(at + 10, column.frame(), 2);
  packet.le(at + 12, column.id() * kTicks / kColumns, 4);
  at += 16;
  for (const Echo& echo : column.echoes) {
    packet.le(at, range_mm(echo, origin_m), 4);
    packet.le(at + 4, static_cast<uint64_t>(std::lround(echo.reflectivity_percent)), 2);
    at += 12;
  }
  packet.le(at, 0xFFFFFFFF, 4);  // valid
}

void put_single_column(PacketBuffer& packet, std::size_t at, const Column& column, double origin_m) {
  packet.le(at, column.stamp_ns(), 8);
  packet.le(at + 8, column.id(), 2);
  packet.le(at + 10, 1, 2);  // valid
  at += 12;
  for (const Echo& echo : column.echoes) {
    packet.le(at, range_mm(echo, origin_m), 4);
    packet.le(at + 4, static_cast<uint64_t>(std::lround(echo.reflectivity_percent)), 1);
    at += 12;
  }
}

}  // namespace

OusterUnit::OusterUnit(const OusterKind& kind, uint64_t unit_seed, double first_turn)
    : metadata_(metadata(kind, unit_seed).dump(1) + "\n"),
      calibration_(parse_ouster_json("simulated", metadata_)),
      first_column_(static_cast<std::size_t>(first_turn * kColumns / kPerPacket) * kPerPacket) {}

std::size_t OusterUnit::firings(int turns) const {
  const std::size_t to_first_turn = (kColumns - first_column_) % kColumns;
  return (to_first_turn + static_cast<std::size_t>(turns) * kColumns + kPerPacket) * beams();
}

Firing OusterUnit::firing(std::size_t index) const {
  const std::size_t row = index % beams(), column = first_column_ + index / beams();
  const double encoder = 2 * kPi * (1 - static_cast<double>(column % kColumns) / kColumns);
  const lidar::Beam& beam = calibration_.beams[row];
  const double azimuth = encoder - beam.azimuth_offset_rad, level = std::cos(beam.elevation_rad);
  const SE3 T_sensor_lidar = SE3::from_matrix(calibration_.ouster.T_sensor_lidar);
  const Vec3 origin = calibration_.ouster.beam_origin_m * Vec3(std::cos(encoder), std::sin(encoder), 0);
  return {T_sensor_lidar * origin,
          T_sensor_lidar.R * Vec3(level * std::cos(azimuth), level * std::sin(azimuth), std::sin(beam.elevation_rad)),
          row};
}

std::vector<std::byte> OusterUnit::pcap(std::span<const Echo> echoes) const {
  const bool legacy = calibration_.ouster.profile == OusterProfile::kLegacy;
  const std::size_t bytes = lidar::OusterPacket::packet_bytes(calibration_.ouster, beams()),
                    each = kPerPacket * beams();
  const std::size_t head = legacy ? 0 : 32, column_bytes = (legacy ? 20 : 12) + 12 * beams();
  PcapWriter writer;
  for (std::size_t first = 0; first + each <= echoes.size(); first += each) {
    PacketBuffer packet(bytes);
    const std::size_t first_column = first_column_ + first / beams();
    if (!legacy) {
      packet.le(0, 1, 2);  // points
      packet.le(2, first_column / kColumns, 2);
      packet.le(7, kSerial, 5);
    }
    for (std::size_t i = 0; i < kPerPacket; ++i) {
      const Column column{first_column + i, echoes.subspan(first + i * beams(), beams())};
      const auto put = legacy ? put_legacy_column : put_single_column;
      put(packet, head + i * column_bytes, column, calibration_.ouster.beam_origin_m);
    }
    writer.add(packet.view(), kRecordingStart_ns + column_ns(first_column + kPerPacket), 7502);
  }
  return writer.bytes();
}

}  // namespace roomcal::tools
