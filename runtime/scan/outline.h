#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/fixed_vector.h"
#include "runtime/map/room_map.h"
#include "runtime/scan/surface.h"

namespace roomcal::scan {

/// A plane and the points that are known to lie on it.
struct PlaneExtent {
  map::MapPlane plane;
  std::span<const Vec3> points_room;  ///< its outline or its markers; may be empty
};

using Outline = FixedVector<Vec3, kMaxFaceEdges>;

/// The outline of planes[i], grown to where it meets the others; counter-clockwise seen from free space.
///
/// Clipped by plane j where the points of i lie in front of j and j reaches as far as i (an inner edge of the room, or
/// the foot of a pillar), and by the back of j where either lies behind the other (an outer edge). On sides where
/// nothing clips it, the outline ends open_margin_m beyond the outermost point.
/// @return empty if nothing is left.
/// Cost: planes x points.
Outline grow_outline(std::span<const PlaneExtent> planes, std::size_t i, double open_margin_m);

}  // namespace roomcal::scan
