#include "tools/map/map_report.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "tools/common/error.h"
#include "tools/map/assets.h"
#include "tools/map/map_builder.h"
#include "tools/map/map_info.h"
#include "tools/page/page.h"

namespace roomcal::tools {

namespace {

using Json = nlohmann::ordered_json;

/// A micrometre, or a millionth: more digits would only make the largest maps' pages large.
double rounded(double value) { return std::round(1e6 * value) / 1e6; }

Json to_json(const Vec3& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }

Json markers_of(const MapData& data) {
  Json markers = Json::array();
  for (const map::MapMarker& m : data.markers) {
    markers.push_back({{"id", m.id},
                       {"p", to_json(m.p_room)},
                       {"n", m.has_normal ? to_json(m.normal_room) : Json()},
                       {"r", m.has_radius ? Json(rounded(m.radius_m)) : Json()},
                       {"sigma_mm", rounded(1e3 * largest_sigma_m(m.cov_m2))},
                       {"plane", m.plane}});
  }
  return markers;
}

Json planes_of(const MapData& data, const Json& description) {
  Json planes = description.at("planes");
  for (std::size_t i = 0; i < planes.size(); ++i) {
    planes[i]["outline"] = Json::array();
    for (const Vec3& vertex : data.planes[i].outline_room) planes[i]["outline"].push_back(to_json(vertex));
  }
  return planes;
}

Json edges_of(const MapData& data) {
  Json lines = Json::array();
  for (const map::MapLine& line : data.lines) {
    lines.push_back({{"from", to_json(line.from_room)}, {"to", to_json(line.to_room)}});
  }
  return lines;
}

Json corners_of(const MapData& data) {
  Json corners = Json::array();
  for (const map::MapCorner& corner : data.corners) corners.push_back(to_json(corner.p_room));
  return corners;
}

Json looks_of(const Coverage& coverage) {
  Json looks = Json::array();
  for (const SampleView& view : coverage.views) {
    looks.push_back({{"at", to_json(view.T_room_cam.t)},
                     {"along", to_json(view.T_room_cam.R.col(2))},
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
  const Json content{{"map", description},
                     {"markers", markers_of(data)},
                     {"planes", planes_of(data, description)},
                     {"lines", edges_of(data)},
                     {"corners", corners_of(data)},
                     {"path", list_at(bake, Json::json_pointer("/path"))},
                     {"looks", looks_of(quality.coverage)},
                     {"advice", quality.advice},
                     {"bake", bake_of(bake)}};
  return make_page("Room map " + description.at("id").get<std::string>(), {map_assets::map_report_js}, content);
}

}  // namespace roomcal::tools
