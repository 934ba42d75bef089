#include "tools/map/complete_map.h"

#include <algorithm>

#include "tools/map/bake_triangles.h"
#include "tools/map/plane_fit.h"
#include "tools/map/structure.h"

namespace roomcal::tools {

void complete_map(MapData& data) {
  std::sort(data.markers.begin(), data.markers.end(),
            [](const map::MapMarker& a, const map::MapMarker& b) { return a.id < b.id; });
  data.planes = fit_planes(data.markers);
  for (map::MapMarker& marker : data.markers) {
    if (marker.has_normal || marker.plane < 0) continue;
    marker.normal_room = data.planes[static_cast<std::size_t>(marker.plane)].plane.normal_room;
    marker.has_normal = marker.normal_estimated = true;
  }
  find_structure(data);
  data.surface_spacing_m = kSurfaceSpacing_m;
  data.triangles = bake_triangles(data.markers);
}

}  // namespace roomcal::tools
