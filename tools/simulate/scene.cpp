#include "tools/simulate/scene.h"

#include <algorithm>

namespace roomcal::tools {

std::vector<SceneMarker> markers_of(const Scene& scene) {
  std::vector<SceneMarker> markers;
  for (const Plane& wall : scene.walls) {
    for (const Decal& decal : wall.decals) {
      if (decal.print != Print::kRings) continue;
      markers.push_back({decal.marker_id, wall.point(decal.centre), wall.normal, decal.radius_m});
    }
  }
  std::sort(markers.begin(), markers.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return markers;
}

}  // namespace roomcal::tools
