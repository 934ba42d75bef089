#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/status.h"
#include "runtime/map/format.h"

namespace roomcal::map {

namespace fbs {
struct RoomMap;
}

// What RoomMap::open() believes only after it looked; one function a layer of the file. Not for other folders.

/// Header: magic, version, its own sum, the payload's size and sum.
/// @param[out] header  the file's, if kOk.
/// @param[out] payload  the bytes behind it, if kOk.
Status check_header(std::span<const std::byte> bytes, FileHeader& header, std::span<const std::byte>& payload);

/// FlatBuffers structure and identifier. @return nullptr if it does not hold.
const fbs::RoomMap* check_structure(std::span<const std::byte> payload);

/// Every number and index of a payload whose structure holds.
Status check_content(const fbs::RoomMap& content);

}  // namespace roomcal::map
