#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/base/sealed.h"

namespace roomcal::store {

/// What a slot of the store, and a record file of the host tools, begins with; the payload is FlatBuffers, schema
/// record.fbs, identifier "RREC". A slot's bytes behind the payload mean nothing; a file has none.
using RecordHeader = SealedHeader;

inline constexpr std::array<char, 8> kMagic{'r', 'o', 'o', 'm', 'r', 'e', 'c', '\n'};
inline constexpr uint32_t kFormatVersion = 1;

/// Limits of a valid record. kMaxRecordBytes is part of the layout on the medium (layout.h): never change it. The
/// largest record that these limits allow takes half of it (record_codec_test prints the figure).
inline constexpr std::size_t kMaxRecordBytes = 16384;
inline constexpr std::size_t kMaxSensors = 12;
inline constexpr std::size_t kMaxReasons = 8;

inline constexpr SealedKind kRecordKind = {
    .magic = kMagic,
    .version = kFormatVersion,
    .max_bytes = kMaxRecordBytes,
    .too_short = "shorter than a record's header",
    .absent = "no record begins here",
    .header_damaged = "the record's header is damaged",
    .other_version = "the record is of another version; update the firmware or the tool",
    .cut_short = "the record is cut short",
    .damaged = "the record's content is damaged",
};

}  // namespace roomcal::store
