#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/math/types.h"
#include "runtime/pose/delaunay.h"

namespace roomcal::pose {

/// The two filters of [P, III-B].
struct TriangleFilter {
  double min_angle_rad = deg_to_rad(20.0);  ///< smaller inner angles make P3P ill-conditioned
  double max_edge_ratio = 5.0;              ///< longest over shortest side
};

/// Scratch bytes of image_triangles(), its result included.
std::size_t image_triangles_bytes(std::size_t bearings);

/// Delaunay triangles of bearings, for any field up to the full sphere.
///
/// The sphere is projected stereographically from the point opposite to the mean bearing: circles stay circles, so the
/// planar triangulation is the one on the sphere. Angles and edges of the filter are those of the chord triangle.
/// @param bearing_cam    unit vectors.
/// @param[out] triples   in the arena; ordered so that det[b0 b1 b2] > 0.
/// @return as delaunay().
Status image_triangles(std::span<const Vec3> bearing_cam, const TriangleFilter& filter, Arena& arena,
                       std::span<Triple>& triples);

/// True if the chord triangle passes both filters.
bool passes(const TriangleFilter& filter, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace roomcal::pose
