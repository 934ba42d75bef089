#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>

#include "runtime/base/crc32c.h"

namespace roomcal::fuzz {

/// Makes the sums of a header with `magic`, `version` and two CRC-32C fit, so that the fuzzer gets past them to what
/// they guard. The header's other fields stay; too few bytes for a header stay as they are.
template <typename Header>
void reseal(std::span<std::byte> bytes, const std::array<char, 8>& magic, uint32_t version) {
  Header header{};
  if (bytes.size() < sizeof header) return;
  std::memcpy(&header, bytes.data(), sizeof header);
  header.magic = magic;
  header.version = version;
  header.payload_bytes = static_cast<uint32_t>(bytes.size() - sizeof header);
  header.payload_crc32c = crc32c(bytes.subspan(sizeof header));
  std::memcpy(bytes.data(), &header, sizeof header);
  header.header_crc32c = crc32c(bytes.first(offsetof(Header, header_crc32c)));
  std::memcpy(bytes.data(), &header, sizeof header);
}

/// Gives `walk` the input as it is and with its sums made to fit, in a heap block of exactly its size, so that reading
/// one byte too far is seen.
template <typename Header, typename Walk>
void walk_sealed(const uint8_t* data, std::size_t size, const std::array<char, 8>& magic, uint32_t version,
                 const Walk& walk) {
  const std::unique_ptr<std::byte[]> block(new std::byte[size]);
  if (size > 0) std::memcpy(block.get(), data, size);
  const std::span<std::byte> bytes(block.get(), size);
  walk(bytes);
  reseal<Header>(bytes, magic, version);
  walk(bytes);
}

}  // namespace roomcal::fuzz
