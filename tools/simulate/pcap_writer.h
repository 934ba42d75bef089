#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/lidar/bytes.h"

namespace roomcal::tools {

/// A pcap file in memory: little-endian, microseconds, Ethernet, IPv4, one datagram a frame.
class PcapWriter {
 public:
  PcapWriter();

  /// @param payload  up to 65,507 bytes.
  void add(lidar::Bytes payload, int64_t arrival_ns, uint16_t port);

  /// To be written by write_atomic().
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

}  // namespace roomcal::tools
