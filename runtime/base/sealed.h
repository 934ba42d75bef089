#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "runtime/base/status.h"

namespace roomcal {

/// What a stored payload begins with; little-endian. Every byte is under one of the two sums.
///
///     offset  size  field
///          0     8  magic
///          8     4  format version
///         12     4  payload size n, bytes
///         16     4  CRC-32C of the payload
///         20     4  CRC-32C of bytes 0..19
///         24     n  payload
struct SealedHeader {
  std::array<char, 8> magic;
  uint32_t version;
  uint32_t payload_bytes;
  uint32_t payload_crc32c;
  uint32_t header_crc32c;
};
static_assert(sizeof(SealedHeader) == 24, "a multiple of 8: the payload's doubles stay aligned");
static_assert(std::is_trivially_copyable_v<SealedHeader>);
static_assert(offsetof(SealedHeader, payload_crc32c) == 16 && offsetof(SealedHeader, header_crc32c) == 20);
static_assert(std::endian::native == std::endian::little, "a big-endian reader has to swap; none of our boards is one");

/// One kind of sealed bytes, and what to say of them that are not.
struct SealedKind {
  std::array<char, 8> magic;
  uint32_t version = 1;
  std::size_t max_bytes = 0;  ///< header included
  const char* too_short = "";
  const char* absent = "";
  const char* header_damaged = "";
  const char* other_version = "";
  const char* cut_short = "";
  const char* damaged = "";
};

/// Header for a payload of this kind.
SealedHeader seal(std::span<const std::byte> payload, const SealedKind& kind);

/// Bytes that the header speaks of, itself included; the payload is not looked at.
/// @return kCorrupt, kUnsupported with the kind's own words.
Result<std::size_t> sealed_size(std::span<const std::byte> bytes, const SealedKind& kind);

/// The payload, after all sums were checked. @param bytes  aligned to 8; may be longer.
/// @return kInvalidArgument if they are not aligned; kCorrupt, kUnsupported with the kind's own words.
Result<std::span<const std::byte>> open_sealed(std::span<const std::byte> bytes, const SealedKind& kind);

}  // namespace roomcal
