#include "runtime/lidar/pcap.h"

#include <algorithm>
#include <array>

namespace roomcal::lidar {

namespace {

constexpr std::size_t kFileHead = 24, kFrameHead = 16;
constexpr uint32_t kLoopback = 0, kEthernet = 1, kRawIp = 101, kRawIpBsd = 12, kCooked = 113, kIpv4 = 228, kIpv6 = 229,
                   kCooked2 = 276, kLoopbackBsd = 108;
constexpr uint16_t kTypeIpv4 = 0x0800, kTypeIpv6 = 0x86DD, kTypeVlan = 0x8100, kTypeQinQ = 0x88A8,
                   kTypeOldQinQ = 0x9100;
constexpr uint8_t kUdp = 17;

bool known_link(uint32_t type) {
  constexpr std::array kKnown = {kLoopback, kEthernet, kRawIp,   kRawIpBsd,   kCooked,
                                 kIpv4,     kIpv6,     kCooked2, kLoopbackBsd};
  return std::find(kKnown.begin(), kKnown.end(), type) != kKnown.end();
}

}  // namespace

Result<PcapHead> read_pcap_head(Bytes file) {
  if (file.size() >= 4 && le32(file, 0) == 0x0A0D0D0A)
    return Status{StatusCode::kUnsupported, "is pcapng; convert it with editcap -F pcap"};
  if (file.size() < kFileHead)
    return Status{StatusCode::kCorrupt, "too short for a pcap file; was the recording stopped at once?"};
  const uint32_t magic = le32(file, 0);
  PcapHead head;
  head.swapped = magic == 0xD4C3B2A1 || magic == 0x4D3CB2A1;
  if (magic != 0xA1B2C3D4 && magic != 0xA1B23C4D && !head.swapped)
    return Status{StatusCode::kCorrupt, "is no pcap file; name the recording of the LiDAR's packets"};
  head.fraction_ns = magic == 0xA1B23C4D || magic == 0x4D3CB2A1 ? 1 : 1000;
  head.link_type = (head.swapped ? be32(file, 20) : le32(file, 20)) & 0x0FFFFFFF;
  return head;
}

Result<PcapReader> PcapReader::open(Bytes file, IpFragments& fragments) {
  const Result<PcapHead> head = read_pcap_head(file);
  if (!head.ok()) return head.status();
  if (!known_link(head.value().link_type))
    return Status{StatusCode::kUnsupported,
                  "frames of this link are not read; record on Ethernet, Linux cooked or raw IP"};
  PcapReader reader;
  reader.bytes_ = file;
  reader.at_ = kFileHead;
  reader.head_ = head.value();
  reader.fragments_ = &fragments;
  return reader;
}

void PcapReader::rewind() {
  finish();
  at_ = std::min(kFileHead, bytes_.size());
}

uint32_t PcapReader::u32(std::size_t at) const { return head_.swapped ? be32(bytes_, at) : le32(bytes_, at); }

bool PcapReader::frame(Bytes& bytes, int64_t& arrival_ns) {
  if (bytes_.size() - at_ < kFrameHead) {
    counters_.truncated = counters_.truncated || at_ != bytes_.size();
    return false;
  }
  const std::size_t recorded = u32(at_ + 8), real = u32(at_ + 12);
  if (recorded > bytes_.size() - at_ - kFrameHead) {
    counters_.truncated = true;
    return false;
  }
  arrival_ns = static_cast<int64_t>(u32(at_)) * 1'000'000'000 + static_cast<int64_t>(u32(at_ + 4)) * head_.fraction_ns;
  bytes = bytes_.subspan(at_ + kFrameHead, recorded);
  at_ += kFrameHead + recorded;
  ++counters_.frames;
  counters_.cut_short += recorded < real;
  return true;
}

/// The IP packet of a frame; false (and counted) if it carries something else.
bool PcapReader::strip_link(Bytes frame, Bytes& packet) {
  std::size_t type_at = 12, head = 14;
  switch (head_.link_type) {
    case kRawIp:
    case kRawIpBsd:
    case kIpv4:
    case kIpv6:
      packet = frame;
      return true;
    case kLoopback:
    case kLoopbackBsd:
      if (frame.size() < 4) return ++counters_.malformed, false;
      packet = frame.subspan(4);
      return true;
    case kCooked:
      type_at = 14;
      head = 16;
      break;
    case kCooked2:
      type_at = 0;
      head = 20;
      break;
    default:
      break;
  }
  if (frame.size() < head) return ++counters_.malformed, false;
  uint16_t type = be16(frame, type_at);
  while ((type == kTypeVlan || type == kTypeQinQ || type == kTypeOldQinQ) && frame.size() >= head + 4) {
    type = be16(frame, head + 2);
    head += 4;
  }
  if (type != kTypeIpv4 && type != kTypeIpv6) return ++counters_.not_ip, false;
  packet = frame.subspan(head);
  return true;
}

bool PcapReader::udp_of_ip(Bytes packet, Bytes& udp) {
  if (packet.empty()) return ++counters_.malformed, false;
  const uint8_t version = u8(packet, 0) >> 4;
  if (version == 4) return udp_of_ipv4(packet, udp);
  if (version == 6) return udp_of_ipv6(packet, udp);
  return ++counters_.not_ip, false;
}

bool PcapReader::udp_of_ipv4(Bytes packet, Bytes& udp) {
  if (packet.size() < 20) return ++counters_.malformed, false;
  const std::size_t head = (u8(packet, 0) & 0x0F) * std::size_t{4};
  const std::size_t total = be16(packet, 2);
  const uint16_t fragment = be16(packet, 6) & 0x3FFF;  // more-fragments bit and offset
  // Early Velodynes send position packets with the IP length of their data packets: the UDP length decides then.
  const std::size_t end = fragment == 0 ? std::min(total, packet.size()) : total;
  if (head < 20 || end < head || end > packet.size()) return ++counters_.malformed, false;
  if (u8(packet, 9) != kUdp) return ++counters_.not_udp, false;
  const Bytes body = packet.subspan(head, end - head);
  if (fragment != 0) return put_together(packet, body, fragment, udp);
  udp = body;
  return true;
}

bool PcapReader::udp_of_ipv6(Bytes packet, Bytes& udp) {
  if (packet.size() < 40) return ++counters_.malformed, false;
  const std::size_t size = be16(packet, 4);
  if (size > packet.size() - 40) return ++counters_.malformed, false;
  if (u8(packet, 6) != kUdp) return ++counters_.not_udp, false;
  udp = packet.subspan(40, size);
  return true;
}

bool PcapReader::put_together(Bytes packet, Bytes body, uint16_t fragment, Bytes& udp) {
  ++counters_.fragments;
  IpFragment piece;
  piece.source = be32(packet, 12);
  piece.destination = be32(packet, 16);
  piece.identification = be16(packet, 4);
  piece.more = (fragment & 0x2000) != 0;
  piece.at = (fragment & 0x1FFF) * std::size_t{8};
  piece.body = body;
  piece.frame = counters_.frames;
  const bool fits = !piece.more || body.size() % 8 == 0;
  const IpFragments::Answer answer = fits ? fragments_->add(piece, udp) : IpFragments::Answer::kMalformed;
  counters_.malformed += answer == IpFragments::Answer::kMalformed;
  counters_.unfinished = fragments_->unfinished();
  return answer == IpFragments::Answer::kWhole;
}

bool PcapReader::next(Datagram& datagram) {
  Bytes bytes, packet, udp;
  while (frame(bytes, datagram.arrival_ns)) {
    if (!strip_link(bytes, packet) || !udp_of_ip(packet, udp)) continue;
    const std::size_t size = udp.size() < 8 ? 0 : be16(udp, 4);
    if (size < 8 || size > udp.size()) {
      ++counters_.malformed;
      continue;
    }
    datagram.source_port = be16(udp, 0);
    datagram.destination_port = be16(udp, 2);
    datagram.payload = udp.subspan(8, size - 8);
    ++counters_.datagrams;
    return true;
  }
  return false;
}

void PcapReader::finish() {
  if (fragments_ == nullptr) return;
  fragments_->finish();
  counters_.unfinished = fragments_->unfinished();
}

}  // namespace roomcal::lidar
