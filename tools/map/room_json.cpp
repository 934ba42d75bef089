#include "tools/map/room_json.h"

#include <algorithm>
#include <cmath>

#include "tools/map/map_info.h"

namespace roomcal::tools {

namespace {

using Json = nlohmann::ordered_json;

Json markers_of(const MapData& data) {
  Json markers = Json::array();
  for (const map::MapMarker& m : data.markers) {
    markers.push_back({{"id", m.id},
                       {"p", rounded(m.p_room)},
                       {"n", m.has_normal ? rounded(m.normal_room) : Json()},
                       {"r", m.has_radius ? Json(rounded(m.radius_m)) : Json()},
                       {"sigma_mm", rounded(1e3 * largest_sigma_m(m.cov_m2))},
                       {"plane", m.plane}});
  }
  return markers;
}

Json planes_of(const MapData& data) {
  Json planes = Json::array();
  for (const PlaneData& plane : data.planes) {
    const auto number = static_cast<int>(planes.size());
    const auto markers = std::count_if(data.markers.begin(), data.markers.end(),
                                       [&](const map::MapMarker& m) { return m.plane == number; });
    Json outline = Json::array();
    for (const Vec3& vertex : plane.outline_room) outline.push_back(rounded(vertex));
    planes.push_back({{"normal", rounded(plane.plane.normal_room)},
                      {"d_m", rounded(plane.plane.d_m)},
                      {"rms_m", plane.plane.rms_m},
                      {"markers", markers},
                      {"outline", std::move(outline)}});
  }
  return planes;
}

Json edges_of(const MapData& data) {
  Json lines = Json::array();
  for (const map::MapLine& line : data.lines) {
    lines.push_back({{"from", rounded(line.from_room)}, {"to", rounded(line.to_room)}});
  }
  return lines;
}

Json corners_of(const MapData& data) {
  Json corners = Json::array();
  for (const map::MapCorner& corner : data.corners) corners.push_back(rounded(corner.p_room));
  return corners;
}

}  // namespace

double rounded(double value) { return std::round(1e6 * value) / 1e6; }

nlohmann::ordered_json rounded(const Vec3& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }

nlohmann::ordered_json room_json(const MapData& data) {
  return {{"markers", markers_of(data)},
          {"planes", planes_of(data)},
          {"lines", edges_of(data)},
          {"corners", corners_of(data)}};
}

}  // namespace roomcal::tools
