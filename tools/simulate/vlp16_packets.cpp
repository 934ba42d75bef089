#include "tools/simulate/vlp16_packets.h"

#include <algorithm>
#include <cmath>

#include "runtime/lidar/model.h"
#include "runtime/math/types.h"
#include "tools/simulate/pcap_writer.h"

namespace roomcal::tools {

namespace {

constexpr double kSequence_us = 55.296, kRangeUnit_m = 0.002;
constexpr std::size_t kBlockBytes = 100, kBlocks = 12, kStampAt = 1200, kModeAt = 1204, kProductAt = 1205;
constexpr int64_t kHour_us = 3'600'000'000;

void put16(Vlp16Packet& packet, std::size_t at, uint16_t value) {
  packet[at] = static_cast<std::byte>(value & 0xFF);
  packet[at + 1] = static_cast<std::byte>(value >> 8);
}

uint16_t range_count(double range_m) {
  const double count = std::round(range_m / kRangeUnit_m);
  return count >= 1 && count <= 65535 ? static_cast<uint16_t>(count) : uint16_t{0};
}

uint16_t azimuth_cdeg(double azimuth_rad) {
  const double cdeg = std::round(rad_to_deg(azimuth_rad) * 100);
  return static_cast<uint16_t>(cdeg - 36000 * std::floor(cdeg / 36000));
}

void put_unit(Vlp16Packet& packet, std::size_t at, double range_m, uint8_t reflectivity) {
  const uint16_t count = range_count(range_m);
  put16(packet, at, count);
  packet[at + 2] = static_cast<std::byte>(count == 0 ? 0 : reflectivity);
}

bool dual(const Vlp16Stream& stream) { return stream.return_mode == lidar::kVelodyneDual; }

std::size_t firings_per_packet(const Vlp16Stream& stream) {
  return dual(stream) ? kVlp16FiringsPerPacket / 2 : kVlp16FiringsPerPacket;
}

/// A block holds two firing sequences. In dual return blocks go in pairs: last returns, then strongest ones.
void put_block(Vlp16Packet& packet, std::size_t block, bool last, std::span<const Vlp16Return> returns) {
  for (std::size_t channel = 0; channel < std::min<std::size_t>(2 * kVlp16Lasers, returns.size()); ++channel) {
    const Vlp16Return& r = returns[channel];
    const bool second = last && r.second_range_m > 0;
    put_unit(packet, block * kBlockBytes + 4 + channel * 3, second ? r.second_range_m : r.range_m,
             second ? r.second_reflectivity : r.reflectivity);
  }
}

}  // namespace

double Vlp16Stream::time_us(std::size_t firing, std::size_t laser) const {
  return kSequence_us * static_cast<double>(firing) + lidar::velodyne_channel_us(lidar::Model::kVlp16, laser);
}

double Vlp16Stream::azimuth_rad(std::size_t firing, std::size_t laser) const {
  return first_azimuth_rad + time_us(firing, laser) * rpm * (2 * kPi / 60e6);
}

std::size_t Vlp16Stream::firings_per_turn() const { return static_cast<std::size_t>(60e6 / rpm / kSequence_us); }

Vlp16Packet make_vlp16_packet(const Vlp16Stream& stream, std::size_t first_firing,
                              std::span<const Vlp16Return> returns) {
  Vlp16Packet packet{};
  const std::size_t group = dual(stream) ? 2 : 1;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const std::size_t sequence = block / group * 2;
    put16(packet, block * kBlockBytes, 0xEEFF);
    put16(packet, block * kBlockBytes + 2, azimuth_cdeg(stream.azimuth_rad(first_firing + sequence, 0)));
    const std::size_t from = std::min(sequence * kVlp16Lasers, returns.size());
    put_block(packet, block, group == 2 && block % 2 == 0, returns.subspan(from));
  }
  const auto stamp_us =
      static_cast<uint32_t>((stream.first_ns / 1000 + std::llround(stream.time_us(first_firing, 0))) % kHour_us);
  put16(packet, kStampAt, static_cast<uint16_t>(stamp_us & 0xFFFF));
  put16(packet, kStampAt + 2, static_cast<uint16_t>(stamp_us >> 16));
  packet[kModeAt] = static_cast<std::byte>(stream.return_mode);
  packet[kProductAt] = static_cast<std::byte>(lidar::info(lidar::Model::kVlp16).product_byte);
  return packet;
}

std::vector<std::byte> make_vlp16_pcap(const Vlp16Stream& stream, std::span<const Vlp16Return> returns,
                                       int64_t start_ns) {
  PcapWriter writer;
  const std::size_t firings = returns.size() / kVlp16Lasers, step = firings_per_packet(stream);
  for (std::size_t first = 0; first + step <= firings; first += step) {
    const Vlp16Packet packet = make_vlp16_packet(stream, first, returns.subspan(first * kVlp16Lasers));
    // A packet leaves when its last firing is in.
    writer.add(packet, start_ns + std::llround(1000 * stream.time_us(first + step, 0)), 2368);
  }
  return writer.bytes();
}

}  // namespace roomcal::tools
