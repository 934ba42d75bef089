#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "runtime/map/room_map.h"
#include "tools/map/map_quality.h"

namespace roomcal::tools {

/// Standard deviation along the worst axis of a position's covariance.
double largest_sigma_m(const Mat33& cov_m2);

/// What is inside a map, as `roomcal map info --json` writes it: id, content_crc32c, provenance, created_unix_s,
/// bytes, markers, with_normal, with_estimated_normal, with_radius, extent_m {min, max}, spacing_m {min, median, max}
/// (nearest neighbour), radius_m {min, max}, sigma_m {min, max} (largest axis of each covariance; 0: exact),
/// triangles, planes [{normal, d_m, rms_m, markers}], lines, corners, surface_spacing_m, uniqueness, quality
/// (map_quality.h).
/// @param bytes  size of the file.
nlohmann::ordered_json describe_map(const map::RoomMap& map, std::size_t bytes, const MapQuality& quality);

/// The same for people, a few lines.
std::string summarize_map(const nlohmann::ordered_json& description, const MapQuality& quality);

}  // namespace roomcal::tools
