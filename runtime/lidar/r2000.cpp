#include "runtime/lidar/r2000.h"

#include <algorithm>
#include <cmath>

#include "runtime/lidar/point_sink.h"

namespace roomcal::lidar {

namespace {

constexpr uint16_t kMagic = 0xA25C;
constexpr std::size_t kTypeAt = 2, kSizeAt = 4, kHeadSizeAt = 8, kScanAt = 10, kStampAt = 14, kFrequencyAt = 34,
                      kScanPointsAt = 38, kPointsAt = 40, kFirstIndexAt = 42, kFirstAngleAt = 44, kAngleStepAt = 48;
constexpr uint32_t kNoEcho32 = 0xFFFFFFFF, kNoEcho20 = 0xFFFFF;
constexpr double kAngleUnit_rad = 1e-4 * kPi / 180;

constexpr std::size_t point_bytes(uint16_t type) { return type == 'A' ? 4 : type == 'B' ? 6 : type == 'C' ? 4 : 0; }

/// NTP time: seconds in the upper, fractions in the lower half.
int64_t ntp_ns(uint64_t ntp) {
  return static_cast<int64_t>(ntp >> 32) * 1'000'000'000 +
         static_cast<int64_t>(((ntp & 0xFFFFFFFF) * 1'000'000'000) >> 32);
}

struct Echo {
  uint32_t range_mm = 0;  ///< 0: none
  uint16_t amplitude = 0;
};

Echo read_echo(Bytes bytes, std::size_t at, uint16_t type) {
  const uint32_t word = le32(bytes, at);
  if (type == 'C') {
    const uint32_t range = word & kNoEcho20;
    return {range == kNoEcho20 ? 0 : range, static_cast<uint16_t>(word >> 20)};
  }
  return {word == kNoEcho32 ? 0 : word, type == 'B' ? le16(bytes, at + 4) : uint16_t{0}};
}

}  // namespace

Status inspect_r2000(const Calibration&, Bytes bytes, PacketHeader& header) {
  if (bytes.size() < kR2000HeadBytes || le16(bytes, 0) != kMagic)
    return {StatusCode::kUnsupported, "an R2000 scan packet begins with 5C A2"};
  const uint16_t type = le16(bytes, kTypeAt), points = le16(bytes, kPointsAt), first = le16(bytes, kFirstIndexAt);
  const std::size_t head = le16(bytes, kHeadSizeAt);
  if (point_bytes(type) == 0) return {StatusCode::kUnsupported, "the packet type is none of A, B, C"};
  if (le32(bytes, kSizeAt) != bytes.size() || head < kR2000HeadBytes || head > bytes.size() ||
      bytes.size() - head < points * point_bytes(type) || points > kMaxPacketPoints)
    return {StatusCode::kCorrupt, "size, head and number of points disagree"};
  header = {};
  header.turn_mark = TurnMark::kNumber;
  header.stamp_ns = ntp_ns(le64(bytes, kStampAt));
  header.turn = le16(bytes, kScanAt);
  header.turn_units = le16(bytes, kScanPointsAt);
  header.packet_units = points;
  header.first_unit = first;
  if (header.turn_units == 0 || first + points > header.turn_units)
    return {StatusCode::kCorrupt, "points beyond the scan's number of points"};
  // Scan frequency is in mHz.
  header.motor_rpm = static_cast<uint16_t>(std::min(65535.0, le32(bytes, kFrequencyAt) * 0.06));
  return ok_status();
}

void decode_r2000(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                  std::span<SweepPoint> points, DecodedPacket& decoded) {
  PointSink sink(points, decoded, info(calibration.model));
  const uint16_t type = le16(bytes, kTypeAt);
  const std::size_t head = le16(bytes, kHeadSizeAt);
  const double first_rad = kAngleUnit_rad * static_cast<int32_t>(le32(bytes, kFirstAngleAt));
  const double step_rad = kAngleUnit_rad * static_cast<int32_t>(le32(bytes, kAngleStepAt));
  const double frequency_hz = 0.001 * le32(bytes, kFrequencyAt);
  // Slower than the scanner turns is no frequency: times then stay those of the packet.
  const double point_ns = frequency_hz >= 10 ? 1e9 / frequency_hz / header.turn_units : 0;
  for (std::size_t i = 0; i < header.packet_units; ++i) {
    const Echo echo = read_echo(bytes, head + i * point_bytes(type), type);
    const double range_m = 0.001 * echo.range_mm + calibration.beams[0].range_offset_m;
    if (echo.range_mm == 0 || !sink.plausible(range_m)) continue;
    const double angle = first_rad + step_rad * static_cast<double>(i);
    const Direction azimuth = Direction::of(angle - kTwoPi * std::floor(angle / kTwoPi));
    SweepPoint& point = sink.add();
    point.x_m = static_cast<float>(range_m * azimuth.cos);
    point.y_m = static_cast<float>(range_m * azimuth.sin);
    point.z_m = 0;
    point.range_m = static_cast<float>(range_m);
    point.azimuth_rad = wrapped(azimuth.angle_rad);
    point.offset_ns = base_ns + static_cast<int32_t>(point_ns * static_cast<double>(i));
    point.beam = 0;
    point.reflectivity = echo.amplitude;
    point.return_index = 0;
  }
}

}  // namespace roomcal::lidar
