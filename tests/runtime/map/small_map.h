#pragma once

#include <cstddef>
#include <vector>

#include "runtime/map/format.h"
#include "tools/map/map_builder.h"

namespace roomcal::map::test {

/// Four markers on a floor and one in the air, three planes that meet, two triangles, ring ratios: every field in use.
inline tools::MapData small_map() {
  tools::MapData data;
  data.id = "lab";
  data.provenance = "made by a test";
  data.created_unix_s = 1700000000;
  for (uint32_t i = 0; i < 5; ++i) {
    MapMarker marker;
    marker.id = 10 * i + 3;
    marker.p_room = Vec3(0.1 + 0.3 * i, 0.2 + 0.07 * i * i, i == 4 ? 1.25 : 0.0);
    marker.cov_m2 << 4e-6, 1e-6, 0, 1e-6, 4e-6, 0, 0, 0, 9e-6;
    if (i < 4) {
      marker.normal_room = Vec3::UnitZ();
      marker.has_normal = true;
      marker.normal_estimated = i == 3;
      marker.plane = 0;
      marker.radius_m = 0.085;
      marker.has_radius = true;
    }
    data.markers.push_back(marker);
  }
  data.planes.push_back({{Vec3::UnitZ(), 0, 0.001}, {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 2, 0)}});
  data.planes.back().plane.cov << 4e-8, 1e-8, 0, 1e-8, 9e-8, -2e-8, 0, -2e-8, 1e-7;
  data.planes.push_back({{Vec3(0.6, 0.8, 0), -1.5, 0.002}, {}});
  data.planes.push_back({{Vec3(-0.8, 0.6, 0), 0, 0.002}, {}});
  data.lines = {{0, 1, Vec3(0.9, 1.2, 0), Vec3(0.1, 1.8, 0)}, {1, 2, Vec3(0.9, 1.2, 0), Vec3(0.9, 1.2, 2.5)}};
  data.corners = {{{0, 1, 2}, Vec3(0.9, 1.2, 0)}};
  data.surface_spacing_m = 0.0625;
  data.triangles = {{0, 1, 2}, {1, 3, 2}};
  data.ring_ratios = {1.0F, 0.85F, 0.7F, 0.55F, 0.4F, 0.25F};
  return data;
}

/// Writes the header's sums anew, so that damage behind them is what the view has to find.
void reseal(tools::AlignedBytes& bytes);

/// A copy cut or padded with zeros to `size`.
tools::AlignedBytes resized(const tools::AlignedBytes& bytes, std::size_t size);

}  // namespace roomcal::map::test
