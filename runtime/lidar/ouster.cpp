#include "runtime/lidar/ouster.h"

#include <algorithm>

#include "runtime/lidar/point_sink.h"

namespace roomcal::lidar {

namespace {

constexpr std::size_t kHeadBytes = 32, kFootBytes = 32;  // of a packet; none in the legacy profile
constexpr std::size_t kColumnHead = 12, kLegacyColumnHead = 16, kLegacyColumnFoot = 4;
constexpr uint32_t kRange20 = 0xFFFFF, kRange19 = 0x7FFFF, kRange15 = 0x7FFF;

bool in_window(const OusterFormat& format, uint16_t column) {
  const bool plain = format.first_column <= format.last_column;
  const bool above = column >= format.first_column, below = column <= format.last_column;
  return column < format.columns_per_frame && (plain ? above && below : above || below);
}

uint16_t window_position(const OusterFormat& format, uint16_t column) {
  return static_cast<uint16_t>((column + format.columns_per_frame - format.first_column) % format.columns_per_frame);
}

OusterPixel two_word_pixel(Bytes p) {
  OusterPixel pixel;
  pixel.range_mm = (le16(p, 0) & kRange15) << 3;
  pixel.flags = static_cast<uint8_t>(u8(p, 1) >> 7);
  pixel.reflectivity = u8(p, 2);
  pixel.near_ir = static_cast<uint16_t>(u8(p, 3) << 4);
  pixel.range2_mm = (le16(p, 4) & kRange15) << 3;
  pixel.flags2 = static_cast<uint8_t>(u8(p, 5) >> 7);
  pixel.reflectivity2 = u8(p, 6);
  return pixel;
}

OusterPixel low_rate_pixel(Bytes p) {
  OusterPixel pixel;
  pixel.range_mm = (le16(p, 0) & kRange15) << 3;
  pixel.flags = static_cast<uint8_t>(u8(p, 1) >> 7);
  pixel.reflectivity = u8(p, 2);
  pixel.near_ir = static_cast<uint16_t>(u8(p, 3) << 4);
  return pixel;
}

OusterPixel dual_pixel(Bytes p) {
  OusterPixel pixel;
  pixel.range_mm = le32(p, 0) & kRange19;
  pixel.flags = static_cast<uint8_t>(u8(p, 2) >> 3);
  pixel.reflectivity = u8(p, 3);
  pixel.range2_mm = le32(p, 4) & kRange19;
  pixel.flags2 = static_cast<uint8_t>(u8(p, 6) >> 3);
  pixel.reflectivity2 = u8(p, 7);
  pixel.signal = le16(p, 8);
  pixel.signal2 = le16(p, 10);
  pixel.near_ir = le16(p, 12);
  return pixel;
}

OusterPixel single_pixel(Bytes p) {
  OusterPixel pixel;
  pixel.range_mm = le32(p, 0) & kRange19;
  pixel.flags = static_cast<uint8_t>(u8(p, 2) >> 3);
  pixel.reflectivity = u8(p, 4);
  pixel.signal = le16(p, 6);
  pixel.near_ir = le16(p, 8);
  return pixel;
}

OusterPixel legacy_pixel(Bytes p) {
  OusterPixel pixel;
  pixel.range_mm = le32(p, 0) & kRange20;
  pixel.flags = static_cast<uint8_t>(u8(p, 3) >> 4);
  pixel.reflectivity = le16(p, 4);
  pixel.signal = le16(p, 6);
  pixel.near_ir = le16(p, 8);
  return pixel;
}

}  // namespace

std::size_t OusterPacket::pixel_bytes(OusterProfile profile) {
  switch (profile) {
    case OusterProfile::kLegacy:
    case OusterProfile::kSingle19:
      return 12;
    case OusterProfile::kDual19:
      return 16;
    case OusterProfile::kLow15:
      return 4;
    case OusterProfile::kFusaDual15:
      return 8;
    case OusterProfile::kFiveWord:
      return 20;
  }
  return 12;
}

std::size_t OusterPacket::packet_bytes(const OusterFormat& format, std::size_t rows) {
  const std::size_t pixels = rows * pixel_bytes(format.profile);
  if (format.profile == OusterProfile::kLegacy)
    return format.columns_per_packet * (kLegacyColumnHead + pixels + kLegacyColumnFoot);
  return kHeadBytes + format.columns_per_packet * (kColumnHead + pixels) + kFootBytes;
}

OusterPacket::OusterPacket(const OusterFormat& format, std::size_t rows, Bytes bytes)
    : profile_(format.profile),
      bytes_(bytes),
      head_bytes_(legacy() ? 0 : kHeadBytes),
      column_head_bytes_(legacy() ? kLegacyColumnHead : kColumnHead),
      pixel_bytes_(pixel_bytes(format.profile)),
      column_bytes_(column_head_bytes_ + rows * pixel_bytes_ + (legacy() ? kLegacyColumnFoot : 0)) {}

std::size_t OusterPacket::pixel_at(std::size_t column, std::size_t row) const {
  return column_at(column) + column_head_bytes_ + row * pixel_bytes_;
}

uint32_t OusterPacket::frame_id() const {
  if (legacy()) return le16(bytes_, 10);
  return profile_ == OusterProfile::kFusaDual15 ? le32(bytes_, 4) : le16(bytes_, 2);
}

uint64_t OusterPacket::serial() const {
  if (legacy()) return 0;
  const std::size_t at = profile_ == OusterProfile::kFusaDual15 ? 11 : 7;
  return le32(bytes_, at) | static_cast<uint64_t>(u8(bytes_, at + 4)) << 32;
}

uint16_t OusterPacket::packet_type() const {
  if (legacy()) return 1;
  return profile_ == OusterProfile::kFusaDual15 ? u8(bytes_, 0) : le16(bytes_, 0);
}

uint32_t OusterPacket::status(std::size_t column) const {
  return legacy() ? le32(bytes_, column_at(column + 1) - kLegacyColumnFoot) : le16(bytes_, column_at(column) + 10);
}

bool OusterPacket::column_valid(std::size_t column) const {
  return legacy() ? status(column) == 0xFFFFFFFF : (status(column) & 1) != 0;
}

uint64_t OusterPacket::timestamp_ns(std::size_t column) const { return le64(bytes_, column_at(column)); }
uint16_t OusterPacket::measurement_id(std::size_t column) const { return le16(bytes_, column_at(column) + 8); }
uint32_t OusterPacket::encoder(std::size_t column) const { return legacy() ? le32(bytes_, column_at(column) + 12) : 0; }

uint32_t OusterPacket::raw_word(std::size_t column, std::size_t row, std::size_t word) const {
  return le32(bytes_, pixel_at(column, row) + 4 * word);
}

OusterPixel OusterPacket::pixel(std::size_t column, std::size_t row) const {
  const Bytes p = bytes_.subspan(pixel_at(column, row), pixel_bytes_);
  switch (profile_) {
    case OusterProfile::kLegacy:
      return legacy_pixel(p);
    case OusterProfile::kSingle19:
      return single_pixel(p);
    case OusterProfile::kDual19:
    case OusterProfile::kFiveWord:
      return dual_pixel(p);
    case OusterProfile::kLow15:
      return low_rate_pixel(p);
    case OusterProfile::kFusaDual15:
      return two_word_pixel(p);
  }
  return {};
}

namespace {

class OusterDecoder {
 public:
  OusterDecoder(const Calibration& calibration, PointSink& sink)
      : calibration_(calibration),
        sink_(sink),
        R_sensor_lidar_(calibration.ouster.T_sensor_lidar.topLeftCorner<3, 3>()),
        t_sensor_lidar_(calibration.ouster.T_sensor_lidar.topRightCorner<3, 1>()) {}

  void column(const OusterPacket& packet, std::size_t column, int32_t offset_ns) {
    const double part = static_cast<double>(packet.measurement_id(column)) / calibration_.ouster.columns_per_frame;
    const Direction encoder = Direction::of(kTwoPi * (1 - part));
    for (uint16_t row = 0; row < calibration_.beam_count; ++row) {
      const OusterPixel pixel = packet.pixel(column, row);
      const Calibration::Trig& trig = calibration_.trig[row];
      const Direction azimuth =
          encoder.turned(-calibration_.beams[row].azimuth_offset_rad, -trig.sin_offset, trig.cos_offset);
      const bool first = pixel.range_mm != 0;
      if (first) add(encoder, azimuth, row, pixel.range_mm, pixel.reflectivity, offset_ns, 0);
      if (pixel.range2_mm != 0 && pixel.range2_mm != pixel.range_mm)
        add(encoder, azimuth, row, pixel.range2_mm, pixel.reflectivity2, offset_ns, first ? 1 : 0);
    }
  }

 private:
  void add(const Direction& encoder, const Direction& azimuth, uint16_t row, uint32_t range_mm, uint16_t reflectivity,
           int32_t offset_ns, uint8_t return_index) {
    const double range_m = 0.001 * range_mm;
    if (!sink_.plausible(range_m)) return;
    const Calibration::Trig& trig = calibration_.trig[row];
    const OusterFormat& format = calibration_.ouster;
    const double along = range_m - format.beam_origin_m, flat = along * trig.cos_elevation;
    const Vec3 p_lidar(flat * azimuth.cos + format.beam_origin_m * encoder.cos,
                       flat * azimuth.sin + format.beam_origin_m * encoder.sin,
                       along * trig.sin_elevation + format.beam_origin_z_m);
    const Vec3 p_sensor = R_sensor_lidar_ * p_lidar + t_sensor_lidar_;
    SweepPoint& point = sink_.add();
    point.x_m = static_cast<float>(p_sensor.x());
    point.y_m = static_cast<float>(p_sensor.y());
    point.z_m = static_cast<float>(p_sensor.z());
    point.range_m = static_cast<float>(range_m);
    point.azimuth_rad = wrapped(azimuth.angle_rad);
    point.offset_ns = offset_ns;
    point.beam = row;
    point.reflectivity = reflectivity;
    point.return_index = return_index;
  }

  const Calibration& calibration_;
  PointSink& sink_;
  Mat33 R_sensor_lidar_;
  Vec3 t_sensor_lidar_;
};

/// Columns of a packet span less than this; more means damaged times.
constexpr int64_t kMaxSpan_ns = 100'000'000;

}  // namespace

Status inspect_ouster(const Calibration& calibration, Bytes bytes, PacketHeader& header) {
  const OusterFormat& format = calibration.ouster;
  if (bytes.size() != OusterPacket::packet_bytes(format, calibration.beam_count))
    return {StatusCode::kUnsupported, "the size is not that of the metadata's profile and beams: is it of this unit?"};
  const OusterPacket packet(format, calibration.beam_count, bytes);
  if (packet.packet_type() != 1) return {StatusCode::kUnsupported, "the packet type is not that of points"};
  header = {};
  header.turn_mark = TurnMark::kNumber;
  header.turn = packet.frame_id();
  header.turn_mask = format.profile == OusterProfile::kFusaDual15 ? 0xFFFFFFFF : 0xFFFF;
  header.turn_units = window_columns(format);
  header.returns = format.profile == OusterProfile::kDual19 || format.profile == OusterProfile::kFusaDual15 ? 2 : 1;
  header.other_sensor = format.serial != 0 && packet.serial() != 0 && packet.serial() != format.serial;
  bool any = false;
  for (std::size_t i = 0; i < format.columns_per_packet; ++i) {
    const uint16_t id = packet.measurement_id(i);
    if (in_window(format, id)) ++header.packet_units;
    if (!packet.column_valid(i)) continue;
    if (id >= format.columns_per_frame) return {StatusCode::kCorrupt, "a column number is beyond the turn's columns"};
    const auto stamp_ns = static_cast<int64_t>(packet.timestamp_ns(i));
    if (!any) {
      header.stamp_ns = stamp_ns;
      header.first_unit = window_position(format, id);
      any = true;
    }
    // Unsigned, so that any two numbers have a difference.
    if (packet.timestamp_ns(i) - static_cast<uint64_t>(header.stamp_ns) > static_cast<uint64_t>(kMaxSpan_ns) ||
        stamp_ns < 0)
      return {StatusCode::kCorrupt, "the times of a packet's columns are not in order"};
  }
  if (!any) return {StatusCode::kUnavailable, "no valid column in the packet"};
  return ok_status();
}

void decode_ouster(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                   std::span<SweepPoint> points, DecodedPacket& decoded) {
  const OusterPacket packet(calibration.ouster, calibration.beam_count, bytes);
  PointSink sink(points, decoded, info(calibration.model));
  OusterDecoder decoder(calibration, sink);
  for (std::size_t i = 0; i < calibration.ouster.columns_per_packet; ++i) {
    if (!packet.column_valid(i)) continue;
    const auto after_ns = static_cast<int64_t>(packet.timestamp_ns(i)) - header.stamp_ns;
    decoder.column(packet, i, base_ns + static_cast<int32_t>(after_ns));
  }
}

}  // namespace roomcal::lidar
