#include "tools/evaluate/scene_map.h"

#include <utility>

#include "tools/map/complete_map.h"

namespace roomcal::tools {

MapData map_data_of(const Scene& scene) {
  MapData data;
  data.id = "simulated";
  data.provenance = "simulated";
  for (const SceneMarker& from : markers_of(scene)) {
    map::MapMarker marker;
    marker.id = static_cast<uint32_t>(from.id);
    marker.p_room = from.centre_room;
    marker.normal_room = from.normal_room;
    marker.radius_m = from.radius_m;
    marker.has_normal = marker.has_radius = true;
    data.markers.push_back(marker);
  }
  complete_map(data);
  return data;
}

LoadedMap open_map(const MapData& data) {
  AlignedBytes bytes = build_map(data);
  const map::RoomMap view = map::RoomMap::open(bytes.span()).value();  // moving a vector keeps its bytes in place
  return {std::move(bytes), view};
}

}  // namespace roomcal::tools
