#include "runtime/lidar/livox.h"

#include <array>
#include <cmath>

#include "runtime/lidar/point_sink.h"

namespace roomcal::lidar {

namespace {

constexpr std::size_t kLengthAt = 1, kIntervalAt = 3, kDotsAt = 5, kCountAt = 7, kTypeAt = 10, kCrcAt = 24,
                      kStampAt = 28;
constexpr uint8_t kMillimetres = 1, kCentimetres = 2;
constexpr uint16_t kLines = 4;

constexpr std::size_t dot_bytes(uint8_t type) { return type == kMillimetres ? 14 : 8; }

constexpr std::array<uint32_t, 256> make_crc_table() {
  std::array<uint32_t, 256> table{};
  for (uint32_t i = 0; i < 256; ++i) {
    uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1) != 0 ? 0xEDB88320U : 0U);
    table[i] = value;
  }
  return table;
}
constexpr std::array<uint32_t, 256> kCrcTable = make_crc_table();

struct Dot {
  Vec3 p_lidar;
  uint8_t reflectivity;
};

Dot read_dot(Bytes bytes, std::size_t at, uint8_t type) {
  if (type == kMillimetres) {
    const auto metres = [&](std::size_t i) { return 0.001 * static_cast<int32_t>(le32(bytes, at + i)); };
    return {Vec3(metres(0), metres(4), metres(8)), u8(bytes, at + 12)};
  }
  const auto metres = [&](std::size_t i) { return 0.01 * static_cast<int16_t>(le16(bytes, at + i)); };
  return {Vec3(metres(0), metres(2), metres(4)), u8(bytes, at + 6)};
}

}  // namespace

uint32_t crc32_ieee(Bytes bytes) {
  uint32_t crc = 0xFFFFFFFF;
  for (const std::byte b : bytes) crc = (crc >> 8) ^ kCrcTable[(crc ^ std::to_integer<uint32_t>(b)) & 0xFF];
  return ~crc;
}

Status inspect_livox(const Calibration&, Bytes bytes, PacketHeader& header) {
  if (bytes.size() < kLivoxHeadBytes) return {StatusCode::kUnsupported, "shorter than a Livox head"};
  const uint8_t type = u8(bytes, kTypeAt);
  if (type != kMillimetres && type != kCentimetres)
    return {StatusCode::kUnsupported, "the data type is neither 1 nor 2: set the unit to Cartesian points"};
  const std::size_t dots = le16(bytes, kDotsAt);
  if (le16(bytes, kLengthAt) != bytes.size() || bytes.size() != kLivoxHeadBytes + dots * dot_bytes(type) ||
      dots > kMaxPacketPoints)
    return {StatusCode::kCorrupt, "length, number of points and size disagree"};
  header = {};
  header.turn_mark = TurnMark::kTime;
  header.stamp_ns = static_cast<int64_t>(le64(bytes, kStampAt));
  if (header.stamp_ns < 0) return {StatusCode::kCorrupt, "the time stamp is absurd"};
  header.has_sequence = true;
  header.sequence = le16(bytes, kCountAt);
  header.sequence_mask = 0xFFFF;
  const uint32_t crc = le32(bytes, kCrcAt);
  header.checksum_wrong = crc != 0 && crc != crc32_ieee(bytes.subspan(kStampAt));
  return ok_status();
}

void decode_livox(const Calibration&, const PacketHeader&, Bytes bytes, int32_t base_ns, std::span<SweepPoint> points,
                  DecodedPacket& decoded) {
  PointSink sink(points, decoded, info(Model::kMid360));
  const uint8_t type = u8(bytes, kTypeAt);
  const std::size_t dots = le16(bytes, kDotsAt);
  const double dot_ns = 100.0 * le16(bytes, kIntervalAt) / static_cast<double>(dots == 0 ? 1 : dots);
  for (std::size_t i = 0; i < dots; ++i) {
    const Dot dot = read_dot(bytes, kLivoxHeadBytes + i * dot_bytes(type), type);
    const double range_m = dot.p_lidar.norm();
    if (range_m == 0 || !sink.plausible(range_m)) continue;
    SweepPoint& point = sink.add();
    point.x_m = static_cast<float>(dot.p_lidar.x());
    point.y_m = static_cast<float>(dot.p_lidar.y());
    point.z_m = static_cast<float>(dot.p_lidar.z());
    point.range_m = static_cast<float>(range_m);
    point.azimuth_rad = wrapped(std::atan2(dot.p_lidar.y(), dot.p_lidar.x()));
    point.offset_ns = base_ns + static_cast<int32_t>(dot_ns * static_cast<double>(i));
    point.beam = static_cast<uint16_t>(i % kLines);
    point.reflectivity = dot.reflectivity;
    point.return_index = 0;
  }
}

}  // namespace roomcal::lidar
