#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/lidar/packet.h"

namespace roomcal::lidar::test {

/// A packet under construction: zero bytes and numbers put at their places.
class PacketBytes {
 public:
  explicit PacketBytes(std::size_t size) : bytes_(size) {}

  void le(std::size_t at, uint64_t value, int count) {
    for (int i = 0; i < count; ++i) bytes_[at + static_cast<std::size_t>(i)] = static_cast<std::byte>(value >> (8 * i));
  }
  void be(std::size_t at, uint64_t value, int count) {
    for (int i = 0; i < count; ++i)
      bytes_[at + static_cast<std::size_t>(i)] = static_cast<std::byte>(value >> (8 * (count - 1 - i)));
  }
  Bytes view() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

struct Decoded {
  Status status;
  PacketHeader header;
  DecodedPacket packet;
  std::vector<SweepPoint> points;
};

inline Decoded decode(const Calibration& calibration, Bytes bytes) {
  Decoded result;
  result.status = inspect_packet(calibration, bytes, result.header);
  if (!result.status.ok()) return result;
  result.points.resize(kMaxPacketPoints);
  result.status = decode_packet(calibration, result.header, bytes, 0, result.points, result.packet);
  result.points.resize(result.packet.point_count);
  return result;
}

/// Beams with different angles, for models whose table is the unit's.
inline Calibration some_calibration(Model model) {
  std::vector<Beam> beams(info(model).beams);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    beams[i].elevation_rad = deg_to_rad(20 - 40.0 * static_cast<double>(i) / static_cast<double>(beams.size()));
    beams[i].azimuth_offset_rad = deg_to_rad(i % 2 == 0 ? 1.5 : -1.5);
  }
  return make_calibration(model, beams).value();
}

}  // namespace roomcal::lidar::test
