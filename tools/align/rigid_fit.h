#pragma once

#include <span>
#include <utility>
#include <vector>

#include "runtime/math/se3.h"

namespace roomcal::tools {

/// A point with its uncertainty, in whatever frame its set has.
struct SpacePoint {
  Vec3 p = Vec3::Zero();
  Mat33 cov_m2 = Mat33::Zero();
};

/// Numbers of points in set a and set b that are the same marker.
using PointPairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// T_a_b of least squares over corresponding points, all alike: p_a[i] = T_a_b * p_b[i].
/// Source: Arun, Huang, Blostein, "Least-squares fitting of two 3-D point sets", PAMI 1987; a reflection is turned into
/// the best rotation (Umeyama 1991). Wants three points that are not on a line.
SE3 fit_rigid(std::span<const Vec3> p_a, std::span<const Vec3> p_b);

/// The factor s with p_a ~ s * p_b about the centroids, rotation as in `T_a_b` (Umeyama 1991, eq. 42).
double fit_scale(std::span<const Vec3> p_a, std::span<const Vec3> p_b, const SE3& T_a_b);

/// The same, each pair weighed by the covariance of its difference: stereo points are ten times worse in depth.
/// @param T_a_b  start. Cost: three Gauss-Newton rounds.
SE3 fit_rigid_weighted(std::span<const SpacePoint> a, std::span<const SpacePoint> b, const PointPairs& pairs,
                       SE3 T_a_b);

}  // namespace roomcal::tools
