#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "runtime/scan/surface.h"
#include "tools/map/complete_map.h"
#include "tools/map/map_builder.h"
#include "tools/simulate/scene.h"

namespace roomcal::scan::test {

/// A map baked from the markers of a simulated room, and its surface.
struct BakedRoom {
  explicit BakedRoom(const tools::Scene& room) : scene(room) {
    tools::MapData data;
    data.id = "test";
    for (const tools::SceneMarker& marker : tools::markers_of(scene)) {
      map::MapMarker m;
      m.id = static_cast<uint32_t>(marker.id);
      m.p_room = marker.centre_room;
      m.normal_room = marker.normal_room;
      m.has_normal = true;
      m.radius_m = marker.radius_m;
      m.has_radius = true;
      data.markers.push_back(m);
    }
    tools::complete_map(data);
    map_bytes = tools::build_map(data);
    map = map::RoomMap::open(std::as_const(map_bytes).span()).value();
    arena_bytes.resize(Surface::bytes(map.plane_count(), map.marker_count()));
    Arena arena{arena_bytes};
    std::vector<std::byte> scratch_bytes(kScratchBytes);
    Arena scratch{scratch_bytes};
    surface = Surface::build(map, {}, arena, scratch).value();
  }
  BakedRoom(const BakedRoom&) = delete;
  BakedRoom& operator=(const BakedRoom&) = delete;

  static constexpr std::size_t kScratchBytes = 64 * 1024;  ///< for Surface::build()

  tools::Scene scene;
  tools::AlignedBytes map_bytes{0};
  map::RoomMap map;
  std::vector<std::byte> arena_bytes;
  Surface surface;
};

}  // namespace roomcal::scan::test
