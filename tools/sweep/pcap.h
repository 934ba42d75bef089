#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "runtime/lidar/bytes.h"

namespace roomcal::tools {

/// A UDP payload of a recording.
struct Datagram {
  lidar::Bytes payload;    ///< into the file, or into the reader's memory where it was put together
  int64_t arrival_ns = 0;  ///< as the recorder stamped it
  uint16_t source_port = 0, destination_port = 0;
};

/// What a reader left out, and why.
struct PcapCounters {
  uint64_t frames = 0, datagrams = 0;
  uint64_t not_ip = 0, not_udp = 0, malformed = 0;  ///< frames of other protocols; frames that contradict themselves
  uint64_t cut_short = 0;                           ///< recorded shorter than they were (snap length)
  uint64_t fragments = 0, unfinished = 0;           ///< IPv4 fragments; datagrams of which some never came
  bool truncated = false;                           ///< the file ends within a frame
};

/// Reads UDP payloads out of a pcap file's bytes: little- and big-endian, micro- and nanoseconds; Ethernet with VLAN
/// tags, Linux cooked (v1, v2), BSD loopback and raw IP; IPv4 with fragments put together, IPv6 without extension
/// headers. Source: draft-ietf-opsawg-pcap; RFC 791.
class PcapReader {
 public:
  /// @param bytes  must outlive the reader and the datagrams.
  /// @throws ToolError for what is no pcap (pcapng is named) and for link types that are not listed above.
  PcapReader(std::string name, lidar::Bytes bytes);

  /// @return false at the end. `datagram.payload` is valid until the next call.
  bool next(Datagram& datagram);

  const PcapCounters& counters() const { return counters_; }
  /// Also counts what never became whole; call at the end.
  void finish();

 private:
  struct Piece {
    std::size_t at = 0;
    std::vector<std::byte> bytes;
  };
  struct Whole {
    std::vector<Piece> pieces;
    std::size_t size = 0;  ///< 0: the last piece has not come
    uint64_t frame = 0;    ///< that its latest piece came in
  };

  uint32_t u32(std::size_t at) const;
  bool frame(lidar::Bytes& bytes, int64_t& arrival_ns);
  bool strip_link(lidar::Bytes frame, lidar::Bytes& packet);
  bool udp_of_ip(lidar::Bytes packet, lidar::Bytes& udp);
  bool udp_of_ipv4(lidar::Bytes packet, lidar::Bytes& udp);
  bool udp_of_ipv6(lidar::Bytes packet, lidar::Bytes& udp);
  bool put_together(lidar::Bytes packet, lidar::Bytes body, uint16_t fragment, lidar::Bytes& udp);
  void forget_old();

  lidar::Bytes bytes_;
  std::size_t at_ = 24;
  bool swapped_ = false;
  int64_t fraction_ns_ = 1000;
  uint32_t link_type_ = 1;
  std::map<std::pair<uint64_t, uint32_t>, Whole> open_;
  std::vector<std::byte> whole_;
  PcapCounters counters_;
};

}  // namespace roomcal::tools
