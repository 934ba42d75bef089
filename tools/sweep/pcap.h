#pragma once

#include <memory>
#include <string>

#include "runtime/lidar/pcap.h"

namespace roomcal::tools {

using lidar::Datagram;
using lidar::PcapCounters;

/// The device's reader (runtime/lidar/pcap.h) over a file's bytes, with memory of its own.
class PcapReader {
 public:
  /// @param bytes  must outlive the reader and the datagrams.
  /// @throws ToolError for what is no pcap (pcapng is named) and for link types that are not read.
  PcapReader(const std::string& name, lidar::Bytes bytes);

  /// @return false at the end. `datagram.payload` is valid until the next call.
  bool next(Datagram& datagram) { return reader_.next(datagram); }

  const PcapCounters& counters() const { return reader_.counters(); }
  /// Also counts what never became whole; call at the end.
  void finish() { reader_.finish(); }

 private:
  std::unique_ptr<lidar::IpFragments> fragments_;
  lidar::PcapReader reader_;
};

}  // namespace roomcal::tools
