#pragma once

#include "tools/common/random.h"
#include "tools/map/map_data.h"

namespace roomcal::tools::test {

/// Markers at random on the floor and the walls of a 4 x 3 x 2.5 m room; without normals or radius.
/// @param sigma_m  noise of the positions, per axis.
inline MapData box_room(std::size_t per_plane, double sigma_m, uint64_t seed) {
  const Vec3 size_m(4, 3, 2.5);
  Random random(seed);
  MapData data;
  data.id = "box";
  data.provenance = "made by a test";
  for (int plane = 0; plane < 5; ++plane) {
    const int axis = plane == 0 ? 2 : (plane - 1) / 2;
    const bool far_side = plane > 0 && plane % 2 == 0;
    for (std::size_t i = 0; i < per_plane; ++i) {
      map::MapMarker marker;
      marker.id = static_cast<uint32_t>(data.markers.size());
      for (int k = 0; k < 3; ++k) marker.p_room[k] = random.uniform(0.1, size_m[k] - 0.1);
      marker.p_room[axis] = far_side ? size_m[axis] : 0;
      for (int k = 0; k < 3; ++k) marker.p_room[k] += sigma_m * random.normal();
      data.markers.push_back(marker);
    }
  }
  return data;
}

/// The inward normal of the plane that box_room() put marker i on.
inline Vec3 box_normal(std::size_t i, std::size_t per_plane) {
  const std::size_t plane = i / per_plane;
  Vec3 normal = Vec3::Zero();
  normal[plane == 0 ? 2 : static_cast<Eigen::Index>((plane - 1) / 2)] = plane > 0 && plane % 2 == 0 ? -1 : 1;
  return normal;
}

}  // namespace roomcal::tools::test
