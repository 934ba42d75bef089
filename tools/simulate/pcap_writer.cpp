#include "tools/simulate/pcap_writer.h"

#include <cassert>

namespace roomcal::tools {

namespace {

void put_le(std::vector<std::byte>& out, uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::byte>(value >> (8 * i)));
}

void put_be(std::vector<std::byte>& out, uint64_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<std::byte>(value >> (8 * i)));
}

constexpr uint64_t kSensorMac = 0x020000000001, kBroadcastMac = 0xFFFFFFFFFFFF;
constexpr uint32_t kSensorIp = 0xC0A801C9, kBroadcastIp = 0xFFFFFFFF;  // 192.168.1.201, the maker's default
constexpr std::size_t kIpHead = 20, kUdpHead = 8, kEthernetHead = 14;

/// RFC 791: one's complement sum of the header's 16-bit words.
uint16_t header_sum(lidar::Bytes header) {
  uint32_t sum = 0;
  for (std::size_t i = 0; i + 1 < header.size(); i += 2) sum += lidar::be16(header, i);
  while (sum >> 16) sum = (sum & 0xFFFF) + (sum >> 16);
  return static_cast<uint16_t>(~sum);
}

}  // namespace

PcapWriter::PcapWriter() {
  put_le(bytes_, 0xA1B2C3D4, 4);
  put_le(bytes_, 2, 2);
  put_le(bytes_, 4, 2);
  put_le(bytes_, 0, 8);
  put_le(bytes_, 65535, 4);
  put_le(bytes_, 1, 4);
}

void PcapWriter::add(lidar::Bytes payload, int64_t arrival_ns, uint16_t port) {
  assert(payload.size() + kIpHead + kUdpHead <= 65535);
  const std::size_t frame = kEthernetHead + kIpHead + kUdpHead + payload.size();
  put_le(bytes_, static_cast<uint64_t>(arrival_ns / 1'000'000'000), 4);
  put_le(bytes_, static_cast<uint64_t>(arrival_ns % 1'000'000'000 / 1000), 4);
  put_le(bytes_, frame, 4);
  put_le(bytes_, frame, 4);
  put_be(bytes_, kBroadcastMac, 6);
  put_be(bytes_, kSensorMac, 6);
  put_be(bytes_, 0x0800, 2);
  const std::size_t ip = bytes_.size();
  put_be(bytes_, 0x4500, 2);
  put_be(bytes_, kIpHead + kUdpHead + payload.size(), 2);
  put_be(bytes_, 0, 4);
  put_be(bytes_, 0x4011, 2);  // 64 hops, UDP
  put_be(bytes_, 0, 2);
  put_be(bytes_, kSensorIp, 4);
  put_be(bytes_, kBroadcastIp, 4);
  const uint16_t sum = header_sum(lidar::Bytes(bytes_).subspan(ip, kIpHead));
  bytes_[ip + 10] = static_cast<std::byte>(sum >> 8);
  bytes_[ip + 11] = static_cast<std::byte>(sum & 0xFF);
  put_be(bytes_, port, 2);
  put_be(bytes_, port, 2);
  put_be(bytes_, kUdpHead + payload.size(), 2);
  put_be(bytes_, 0, 2);  // no checksum, as RFC 768 allows
  bytes_.insert(bytes_.end(), payload.begin(), payload.end());
}

}  // namespace roomcal::tools
