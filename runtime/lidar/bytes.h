#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

namespace roomcal::lidar {

/// A packet's payload as it came from the wire.
using Bytes = std::span<const std::byte>;

/// Byte `at` of the packet. @pre at < bytes.size()
inline uint8_t u8(Bytes bytes, std::size_t at) {
  assert(at < bytes.size());
  return std::to_integer<uint8_t>(bytes[at]);
}

/// Little-endian numbers of 2, 4 and 8 bytes at `at`. @pre they lie within the packet.
inline uint16_t le16(Bytes bytes, std::size_t at) {
  return static_cast<uint16_t>(u8(bytes, at) | u8(bytes, at + 1) << 8);
}
inline uint32_t le32(Bytes bytes, std::size_t at) {
  return le16(bytes, at) | static_cast<uint32_t>(le16(bytes, at + 2)) << 16;
}
inline uint64_t le64(Bytes bytes, std::size_t at) {
  return le32(bytes, at) | static_cast<uint64_t>(le32(bytes, at + 4)) << 32;
}

/// Big-endian numbers of 2 and 4 bytes at `at`. @pre they lie within the packet.
inline uint16_t be16(Bytes bytes, std::size_t at) {
  return static_cast<uint16_t>(u8(bytes, at) << 8 | u8(bytes, at + 1));
}
inline uint32_t be32(Bytes bytes, std::size_t at) {
  return static_cast<uint32_t>(be16(bytes, at)) << 16 | be16(bytes, at + 2);
}

}  // namespace roomcal::lidar
