#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/status.h"
#include "runtime/store/format.h"
#include "runtime/store/record.h"

namespace roomcal::store {

/// Bytes that encode_record() builds in, beside the output.
inline constexpr std::size_t kEncodeScratchBytes = kMaxRecordBytes;

/// Writes header and payload, as they stand in a slot and in a record file. The same record gives the same bytes.
///
/// @param[out] out  aligned to 8; begins with the result, the rest is untouched.
/// @param scratch  aligned to 16, kEncodeScratchBytes.
/// @return the number of bytes; kCorrupt for a record that check_record() refuses; kCapacity if `out` is too small;
///         kInvalidArgument for a scratch that is too small or askew.
/// Cost: linear in the sensors; no heap.
Result<std::size_t> encode_record(const Record& record, std::span<std::byte> out, std::span<std::byte> scratch);

/// Reads what encode_record() wrote. Total: any bytes give a record or a status.
///
/// @param bytes  aligned to 8; may be longer than the record.
/// @param[out] record  overwritten; its content means something only when ok.
/// @return kCorrupt for bytes that are damaged, cut or hold impossible values; kUnsupported for another version.
Status decode_record(std::span<const std::byte> bytes, Record& record);

/// Size of the record that these bytes begin with, header included.
/// @param bytes  at least sizeof(RecordHeader).
/// @return kCorrupt for a damaged or missing header; kUnsupported for another version.
Result<std::size_t> record_size(std::span<const std::byte> bytes);

}  // namespace roomcal::store
