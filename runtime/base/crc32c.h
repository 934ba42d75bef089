#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace roomcal {

/// CRC-32C (Castagnoli), reflected, initial value and final xor all ones, as in iSCSI (RFC 3720, B.4).
///
/// Check value: crc32c of the nine characters "123456789" is 0xE3069283.
/// @param before  result for the bytes that came before, so that crc32c(b, crc32c(a)) = crc32c(a then b).
/// Cost: one table look-up a byte (1 KiB table, in read-only data).
uint32_t crc32c(std::span<const std::byte> bytes, uint32_t before = 0);

}  // namespace roomcal
