#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/math/types.h"

namespace roomcal::pose {

/// Triples of point numbers, counter-clockwise (x to the right, y up).
using Triple = std::array<uint16_t, 3>;

/// Scratch and output bytes of delaunay() for this many points.
std::size_t delaunay_bytes(std::size_t points);

/// Delaunay triangulation of points in the plane: no point lies inside the circumcircle of a triangle.
///
/// Points are inserted one by one into a large triangle and edges flipped until the circles are empty (Lawson, 1977).
/// Points that coincide with an earlier one are left out; slivers along the convex hull may be missing, because the
/// outermost triangle is finite. Four points on one circle get one of their two diagonals.
/// @param point       at most 65532, finite.
/// @param arena       room for delaunay_bytes(); everything is taken from it, the result included.
/// @param[out] triples  lives in the arena; empty for fewer than three points or collinear ones.
/// @return kOk; kCapacity (too many points); kOutOfMemory.
/// Cost: about n sqrt(n) for the walks plus n flips; no recursion.
Status delaunay(std::span<const Vec2> point, Arena& arena, std::span<Triple>& triples);

}  // namespace roomcal::pose
