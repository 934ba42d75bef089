#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace roomcal::store {

/// What a slot of the store, and a record file of the host tools, begins with; little-endian:
///
///     offset  size  field
///          0     8  magic "roomrec\n"
///          8     4  format version
///         12     4  payload size n, bytes
///         16     4  CRC-32C of the payload
///         20     4  CRC-32C of bytes 0..19
///         24     n  payload: FlatBuffers, schema record.fbs, identifier "RREC"
///
/// Every byte of a record is under one of the two sums. A slot's bytes behind the payload mean nothing; a file has
/// none.
struct RecordHeader {
  std::array<char, 8> magic;
  uint32_t version;
  uint32_t payload_bytes;
  uint32_t payload_crc32c;
  uint32_t header_crc32c;
};
static_assert(sizeof(RecordHeader) == 24, "a multiple of 8: the payload's doubles stay aligned");
static_assert(std::is_trivially_copyable_v<RecordHeader>);
static_assert(offsetof(RecordHeader, payload_crc32c) == 16 && offsetof(RecordHeader, header_crc32c) == 20);
static_assert(std::endian::native == std::endian::little, "a big-endian reader has to swap; none of our boards is one");

inline constexpr std::array<char, 8> kMagic{'r', 'o', 'o', 'm', 'r', 'e', 'c', '\n'};
inline constexpr uint32_t kFormatVersion = 1;

/// Limits of a valid record. kMaxRecordBytes is part of the layout on the medium (layout.h): never change it. The
/// largest record that these limits allow takes half of it (record_codec_test prints the figure).
inline constexpr std::size_t kMaxRecordBytes = 16384;
inline constexpr std::size_t kMaxSensors = 12;
inline constexpr std::size_t kMaxReasons = 8;

}  // namespace roomcal::store
