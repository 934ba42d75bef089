#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/map/room_map.h"
#include "runtime/map/triangle_index.h"

namespace roomcal::tools {

struct BakeTrianglesOptions {
  std::size_t views = 3000;                 ///< simulated looks into the room; more: a steadier order
  std::size_t max_triples_per_marker = 16;  ///< bounds the table: 340 markers then take 33 kB
  double miss_probability = 0.15;           ///< of a marker in view: what a detector or a person in the way costs
  double min_range_m = 0.3;
  double max_range_m = 8.0;
  double max_slant_rad = deg_to_rad(75.0);
  uint32_t seed = 1;
};

/// Triples of markers that can be neighbours in an image, most probable first: the table behind TriangleIndex.
///
/// [P, III-B] enumerates all triples with edges up to 1 m, millions at run time. Here cameras are put at random places
/// inside the room, the markers that they would see go through the runtime's own Delaunay triangulation and filters,
/// and the triples that occur are counted. Occlusion by corners and walls of other planes, missed markers and triangles
/// across a corner are so included with their true weight. Triples go counter-clockwise as seen from inside.
/// @param markers  a normal of length zero means unknown: such a marker is seen from everywhere.
/// @throws ToolError for more markers than the index can number.
/// Cost: about a second for 340 markers. Deterministic.
std::vector<map::MarkerTriple> bake_triangles(std::span<const map::MapMarker> markers,
                                              const BakeTrianglesOptions& options = {});

}  // namespace roomcal::tools
