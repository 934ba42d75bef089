#include "tools/map/map_report.h"

#include <algorithm>
#include <set>

#include "tools/common/error.h"
#include "tools/map/assets.h"
#include "tools/map/map_builder.h"
#include "tools/map/room_json.h"
#include "tools/page/page.h"

namespace roomcal::tools {

namespace {

using Json = nlohmann::ordered_json;

Json looks_of(const Coverage& coverage) {
  Json looks = Json::array();
  for (const SampleView& view : coverage.views) {
    looks.push_back({{"at", rounded(view.T_room_cam.t)},
                     {"along", rounded(view.T_room_cam.R.col(2))},
                     {"markers", view.markers},
                     {"located", view.located},
                     {"sigma_mm", rounded(1e3 * view.sigma_m)}});
  }
  return looks;
}

void check_same_map(const MapData& data, const Json& bake) {
  const Json* markers = bake.is_object() && bake.contains("marker") ? &bake["marker"] : nullptr;
  if (markers == nullptr || !markers->is_array()) {
    throw ToolError("--bake-json: no list `marker` in it; give the file that `roomcal bake --json` wrote");
  }
  std::set<uint32_t> ids;
  for (const map::MapMarker& m : data.markers) ids.insert(m.id);
  const auto known = std::count_if(markers->begin(), markers->end(), [&](const Json& marker) {
    return marker.is_object() && marker.contains("id") && marker["id"].is_number_unsigned() &&
           ids.contains(marker["id"].get<uint32_t>());
  });
  if (2 * static_cast<std::size_t>(known) < std::max(markers->size(), data.markers.size())) {
    throw ToolError("--bake-json: its markers are not those of the map; give the file of the same bake");
  }
}

Json list_at(const Json& node, const Json::json_pointer& where) {
  return node.is_object() && node.contains(where) && node.at(where).is_array() ? node.at(where) : Json::array();
}

/// What the page shows of a bake's figures.
Json bake_of(const Json& bake) {
  if (bake.is_null()) return bake;
  Json kept{{"marker", Json::array()}};
  for (const char* name : {"error_mm", "reprojection"}) {
    if (bake.contains(name)) kept[name] = bake[name];
  }
  for (const Json& marker : bake["marker"]) {
    Json figures;
    for (const char* name : {"id", "held_out_mm", "rms_px", "sightings"}) {
      if (!marker.contains(name)) continue;
      figures[name] = marker[name].is_number_float() ? Json(rounded(marker[name].get<double>())) : marker[name];
    }
    if (figures.contains("id")) kept["marker"].push_back(figures);
  }
  return kept;
}

}  // namespace

std::string map_report(const map::RoomMap& map, const Json& description, const MapQuality& quality, const Json& bake) {
  const MapData data = to_map_data(map);
  if (!bake.is_null()) check_same_map(data, bake);
  Json content = room_json(data);
  content["map"] = description;
  content["path"] = list_at(bake, Json::json_pointer("/path"));
  content["looks"] = looks_of(quality.coverage);
  content["advice"] = quality.advice;
  content["bake"] = bake_of(bake);
  return make_page("Room map " + description.at("id").get<std::string>(), {},
                   {map_assets::map_tables_js, map_assets::map_report_js}, content);
}

}  // namespace roomcal::tools
