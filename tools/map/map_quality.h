#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/map/coverage.h"
#include "tools/map/uniqueness.h"

namespace roomcal::tools {

struct PlaneQuality {
  std::size_t markers = 0;
  double rms_m = 0, max_m = 0;  ///< of its markers' distances to it
  uint32_t worst_id = 0;        ///< the marker that is farthest off
};

/// How good a map is for those who stand in its room: all of it follows from the map itself.
struct MapQuality {
  std::vector<PlaneQuality> planes;  ///< as MapData::planes
  Coverage coverage;
  std::optional<Uniqueness> uniqueness;  ///< absent below 18 markers
  std::vector<std::string> advice;       ///< what to add, move or check, most important first; empty: nothing
};

/// @param data  a whole map (complete_map()). Cost: some seconds for 340 markers. Deterministic.
MapQuality measure_map_quality(const MapData& data, const CoverageOptions& options = {});

/// {planes [{markers, rms_mm, max_mm, worst_id}], coverage {views, seen_share, located_share, median_sigma_mm,
/// median_sigma_deg, least_gap, median_gap}, uniqueness {neighbours, worst_mm, worst_ids, median_mm} or null, advice}.
nlohmann::ordered_json map_quality_json(const MapQuality& quality);

/// The same for people, a few lines.
std::string map_quality_text(const MapQuality& quality);

}  // namespace roomcal::tools
