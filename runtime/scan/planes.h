#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/fixed_vector.h"
#include "runtime/math/types.h"
#include "runtime/scan/ray_block.h"

namespace roomcal::scan {

inline constexpr std::size_t kMaxSweepPlanes = 12;

/// A plane seen in a sweep: normal_lidar . p + d_m = 0; the sensor is on its free side, so d_m > 0.
struct SweepPlane {
  Vec3 normal_lidar = Vec3::UnitZ();
  double d_m = 0;
  double rms_m = 0;
  uint32_t points = 0;  ///< of the sample
};
using SweepPlanes = FixedVector<SweepPlane, kMaxSweepPlanes>;

/// Planes of a sweep, those with most points first.
///
/// Sequential RANSAC: triples of points that were fired soon after each other, so that most lie on one wall; each plane
/// is refitted three times to all its points and takes them away.
/// @param sample    rays in the order of firing, spread over the sweep; at most Samples::kMaxRays are looked at.
/// @param sigma_m   of a range, beam offsets included.
/// Deterministic. Cost: about 0.05 ms a plane for 2000 points.
SweepPlanes extract_planes(std::span<const RayBlock> sample, double sigma_m);

/// Where three planes of a sweep meet, with their directions made orthogonal [P, III-C].
struct Corner {
  Vec3 p_lidar = Vec3::Zero();
  /// Columns: the three normals, turned as little as possible to stand on each other; det +1 or -1 as the normals'.
  Mat33 directions_lidar = Mat33::Identity();
  std::array<uint8_t, 3> plane{};  ///< numbers among the sweep's planes, ascending
};
inline constexpr std::size_t kMaxCorners = 32;
using Corners = FixedVector<Corner, kMaxCorners>;

/// Corners of all triples of planes that stand on each other within 15 degrees, strongest planes first.
Corners find_corners(const SweepPlanes& planes);

}  // namespace roomcal::scan
