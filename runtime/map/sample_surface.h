#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/map/room_map.h"

namespace roomcal::map {

/// A point that stands for a piece of a plane, spacing x spacing large.
struct SurfacePoint {
  Eigen::Vector3f p_room = Eigen::Vector3f::Zero();
  uint16_t plane = 0;  ///< its normal is the plane's
};

/// Points that sample_surface() gives; 0 where it refuses.
/// @param spacing_m  0: the map's own (RoomMap::surface_spacing_m), or 0.05 where it has none.
std::size_t surface_point_count(const RoomMap& map, double spacing_m = 0);

/// The planes as a cloud of points on a regular grid within each outline [P, III-C: the densified map], for point to
/// plane registration. Kept out of the file: 20,000 points of a room would be five times the rest of it, and follow
/// from the outlines. Deterministic; planes without outline give none.
///
/// @param spacing_m  as above. @param arena  keeps the points, 16 bytes each. @param[out] points  by plane, then row.
/// @return kInvalidArgument (a spacing out of format.h's range, or more than 20,000 rows on a plane), kOutOfMemory;
/// `points` is empty then. Cost: linear in the points and in the outlines' vertices times rows.
Status sample_surface(const RoomMap& map, double spacing_m, Arena& arena, std::span<SurfacePoint>& points);

}  // namespace roomcal::map
