#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/lidar/bytes.h"

namespace roomcal::tools {

/// A packet under construction: zero bytes, and numbers put at their places.
class PacketBuffer {
 public:
  explicit PacketBuffer(std::size_t size) : bytes_(size) {}

  /// The lower `count` bytes of a number, little-endian. @pre they lie within the packet
  void le(std::size_t at, uint64_t value, int count) {
    for (int i = 0; i < count; ++i) bytes_[at + static_cast<std::size_t>(i)] = static_cast<std::byte>(value >> (8 * i));
  }
  lidar::Bytes view() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

/// A range as the number of units that a packet has for it; 0, which is "nothing", if it does not fit.
inline uint32_t range_count(double range_m, double unit_m, uint32_t most) {
  const double count = range_m / unit_m + 0.5;
  return count >= 1 && count < most + 1.0 ? static_cast<uint32_t>(count) : 0;
}

}  // namespace roomcal::tools
