#pragma once

#include <cstdint>

#include "runtime/base/status.h"
#include "runtime/lidar/bytes.h"
#include "runtime/lidar/ip_fragments.h"

namespace roomcal::lidar {

/// A UDP payload of a recording.
struct Datagram {
  Bytes payload;           ///< into the file, or into the reader's memory where it was put together
  int64_t arrival_ns = 0;  ///< as the recorder stamped it, UTC
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

/// What a pcap file's head says.
struct PcapHead {
  bool swapped = false;        ///< big-endian
  int64_t fraction_ns = 1000;  ///< unit of the second half of its stamps
  uint32_t link_type = 1;
};

/// @return kUnsupported for pcapng; kCorrupt for what is no pcap. Any link type passes.
Result<PcapHead> read_pcap_head(Bytes file);

/// Reads UDP payloads out of a pcap file's bytes: little- and big-endian, micro- and nanoseconds; Ethernet with VLAN
/// tags, Linux cooked (v1, v2), BSD loopback and raw IP; IPv4 with fragments put together, IPv6 without extension
/// headers. Source: draft-ietf-opsawg-pcap; RFC 791. No allocation; total on any bytes.
class PcapReader {
 public:
  PcapReader() = default;

  /// @param file  must outlive the reader and the datagrams. @param fragments  the same; for this reader alone.
  /// @return as read_pcap_head(), and kUnsupported for link types that are not listed above.
  static Result<PcapReader> open(Bytes file, IpFragments& fragments);

  /// @return false at the end. `datagram.payload` is valid until the next call.
  bool next(Datagram& datagram);

  /// finish(), and back to the first frame; counters go on.
  void rewind();

  const PcapCounters& counters() const { return counters_; }
  /// Also counts what never became whole; call at the end.
  void finish();

 private:
  uint32_t u32(std::size_t at) const;
  bool frame(Bytes& bytes, int64_t& arrival_ns);
  bool strip_link(Bytes frame, Bytes& packet);
  bool udp_of_ip(Bytes packet, Bytes& udp);
  bool udp_of_ipv4(Bytes packet, Bytes& udp);
  bool udp_of_ipv6(Bytes packet, Bytes& udp);
  bool put_together(Bytes packet, Bytes body, uint16_t fragment, Bytes& udp);

  Bytes bytes_;
  std::size_t at_ = 0;
  PcapHead head_;
  IpFragments* fragments_ = nullptr;
  PcapCounters counters_;
};

}  // namespace roomcal::lidar
