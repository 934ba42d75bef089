#include "tools/sweep/realign.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "runtime/lidar/robosense.h"

namespace roomcal::tools {

using lidar::Bytes;

namespace {

constexpr std::size_t kPacket = lidar::kRobosensePacketBytes, kHead = 42, kBlockBytes = 100, kBlocks = 12, kUnit = 3;
constexpr std::size_t kMaxGap = 16;  // bytes; stamps and lengths in message layouts are 4, 8 or 16

struct Stream {
  std::vector<std::byte> bytes;
  std::vector<bool> missing;
};

Stream join(const std::vector<std::vector<std::byte>>& pieces, std::size_t gap) {
  Stream stream;
  for (const std::vector<std::byte>& piece : pieces) {
    stream.bytes.insert(stream.bytes.end(), piece.begin(), piece.end());
    stream.missing.resize(stream.bytes.size(), false);
    stream.bytes.resize(stream.bytes.size() + gap, std::byte{0});
    stream.missing.resize(stream.bytes.size(), true);
  }
  return stream;
}

bool missing_in(const Stream& stream, std::size_t at, std::size_t count) {
  for (std::size_t i = at; i < at + count; ++i)
    if (stream.missing[i]) return true;
  return false;
}

/// Head whole, and every block's mark at its place where it is not missing.
bool packet_at(const Stream& stream, std::size_t at) {
  if (at + kPacket > stream.bytes.size()) return false;
  const Bytes packet(stream.bytes.data() + at, kPacket);
  if (lidar::be32(packet, 0) != lidar::kMsopId) return false;
  if (missing_in(stream, at, kHead)) return false;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    const std::size_t block = kHead + i * kBlockBytes;
    if (!missing_in(stream, at + block, 4) && lidar::be16(packet, block) != 0xFFEE) return false;
  }
  return true;
}

std::vector<std::size_t> packets_in(const Stream& stream) {
  constexpr std::array kMagic = {std::byte{0x55}, std::byte{0xAA}, std::byte{0x05}, std::byte{0x5A}};
  std::vector<std::size_t> found;
  auto it = stream.bytes.begin();
  while (true) {
    it = std::search(it, stream.bytes.end(), kMagic.begin(), kMagic.end());
    if (it == stream.bytes.end()) return found;
    const auto at = static_cast<std::size_t>(it - stream.bytes.begin());
    if (packet_at(stream, at)) found.push_back(at);
    ++it;
  }
}

void put16(std::vector<std::byte>& packet, std::size_t at, std::size_t value) {
  packet[at] = static_cast<std::byte>(value >> 8);
  packet[at + 1] = static_cast<std::byte>(value & 0xFF);
}

/// A block whose mark or azimuth is missing keeps its place, between its neighbours, and none of its ranges.
void empty_block(std::vector<std::byte>& packet, std::size_t number) {
  const auto azimuth = [&](std::size_t block) { return lidar::be16(packet, kHead + block * kBlockBytes + 2); };
  const std::size_t before = number == 0 ? azimuth(1) * 2U + 36000 - azimuth(2) : azimuth(number - 1);
  const std::size_t after = number + 1 < kBlocks ? azimuth(number + 1) : before + 40;
  const std::size_t step = (after + 72000 - before) % 36000;
  const std::size_t block = kHead + number * kBlockBytes;
  std::fill_n(packet.begin() + static_cast<std::ptrdiff_t>(block), kBlockBytes, std::byte{0});
  put16(packet, block, 0xFFEE);
  put16(packet, block + 2, (before + step / 2) % 36000);
}

/// Takes the range from every channel that misses a byte: a half number is no number.
std::vector<std::byte> without_torn_channels(const Stream& stream, std::size_t at) {
  std::vector<std::byte> packet(stream.bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                stream.bytes.begin() + static_cast<std::ptrdiff_t>(at + kPacket));
  for (std::size_t i = kHead; i < kHead + kBlocks * kBlockBytes; ++i) {
    if (!stream.missing[at + i]) continue;
    const std::size_t in_block = (i - kHead) % kBlockBytes;
    if (in_block < 4) {
      empty_block(packet, (i - kHead) / kBlockBytes);
      continue;
    }
    const std::size_t unit = i - (in_block - 4) % kUnit;
    packet[unit] = packet[unit + 1] = std::byte{0};
  }
  return packet;
}

}  // namespace

bool Realigner::torn(Bytes payload) {
  if (payload.size() != kPacket) return false;
  const uint32_t head = lidar::be32(payload, 0);
  return head != lidar::kMsopId && head != lidar::kDifopId;
}

void Realigner::add(Bytes payload) { pieces_.emplace_back(payload.begin(), payload.end()); }

void Realigner::deliver(const std::function<void(Bytes)>& take) const {
  if (pieces_.empty()) return;
  Stream best;
  std::vector<std::size_t> packets;
  for (std::size_t gap = 0; gap <= kMaxGap; ++gap) {
    Stream stream = join(pieces_, gap);
    std::vector<std::size_t> found = packets_in(stream);
    if (found.size() <= packets.size()) continue;
    packets = std::move(found);
    best = std::move(stream);
  }
  for (const std::size_t at : packets) take(without_torn_channels(best, at));
}

}  // namespace roomcal::tools
