#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "runtime/map/room_map.h"

namespace roomcal::tools {

/// What is inside a map, as `roomcal map info --json` writes it: id, content_crc32c, provenance, created_unix_s,
/// bytes, markers, with_normal, with_estimated_normal, with_radius, extent_m {min, max}, spacing_m {min, median, max}
/// (nearest neighbour), radius_m {min, max}, sigma_m {min, max} (largest axis of each covariance; 0: exact),
/// triangles, planes [{normal, d_m, rms_m, markers}], uniqueness {neighbours, worst_mm, worst_ids, median_mm} or null.
/// @param bytes  size of the file.
nlohmann::ordered_json describe_map(const map::RoomMap& map, std::size_t bytes);

/// The same for people, a few lines.
std::string summarize_map(const nlohmann::ordered_json& description);

}  // namespace roomcal::tools
