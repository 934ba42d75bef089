#pragma once

#include <span>

#include "runtime/lidar/packet.h"

namespace roomcal::lidar {

/// One pixel of an Ouster packet with every field its profile has (others 0).
struct OusterPixel {
  uint32_t range_mm = 0, range2_mm = 0;
  uint16_t reflectivity = 0, reflectivity2 = 0;
  uint16_t signal = 0, signal2 = 0, near_ir = 0;
  uint8_t flags = 0, flags2 = 0;
};

/// Reads the fields of one point packet in place. Source: Ouster firmware user manual, "Lidar data packet format"; the
/// field masks as facts also in ouster-sdk, parsing.cpp.
class OusterPacket {
 public:
  /// @pre bytes.size() == packet_bytes(format, rows)
  OusterPacket(const OusterFormat& format, std::size_t rows, Bytes bytes);

  static std::size_t packet_bytes(const OusterFormat& format, std::size_t rows);
  static std::size_t pixel_bytes(OusterProfile profile);

  uint32_t frame_id() const;
  uint64_t serial() const;       ///< 0: not said (legacy)
  uint16_t packet_type() const;  ///< 1 for points; legacy: always 1
  bool column_valid(std::size_t column) const;
  uint64_t timestamp_ns(std::size_t column) const;
  uint16_t measurement_id(std::size_t column) const;
  uint32_t status(std::size_t column) const;
  uint32_t encoder(std::size_t column) const;  ///< legacy only, else 0
  OusterPixel pixel(std::size_t column, std::size_t row) const;
  /// 32-bit word `word` of a pixel as it stands in the packet. @pre within the pixel
  uint32_t raw_word(std::size_t column, std::size_t row, std::size_t word) const;

 private:
  bool legacy() const { return profile_ == OusterProfile::kLegacy; }
  std::size_t column_at(std::size_t column) const { return head_bytes_ + column * column_bytes_; }
  std::size_t pixel_at(std::size_t column, std::size_t row) const;

  OusterProfile profile_;
  Bytes bytes_;
  std::size_t head_bytes_, column_head_bytes_, pixel_bytes_, column_bytes_;
};

/// Ouster OS0, OS1, OS2, legacy and configurable profiles. Points are in the sensor frame (x forward), with
///   t = 2 pi (1 - column / columns), a = -azimuth offset, n = beam origin:
///   x = (r - n) cos(t + a) cos(e) + n cos(t), y likewise with sines, z = (r - n) sin(e), then T_sensor_lidar.
/// As inspect_packet() and decode_packet(); kUnavailable for a packet without a valid column.
Status inspect_ouster(const Calibration& calibration, Bytes bytes, PacketHeader& header);
void decode_ouster(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                   std::span<SweepPoint> points, DecodedPacket& decoded);

}  // namespace roomcal::lidar
