#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "tools/align/rigid_fit.h"

namespace roomcal::tools {

struct TriangleMatchOptions {
  double slack_m = 0.004;       ///< per axis, added to what the covariances say, at the end
  double start_slack_m = 0.05;  ///< the same while a transform comes from three noisy points
  double max_chi2 = 16;         ///< of a pair's squared Mahalanobis distance, 3 degrees: 99.9 %
  double max_edge_m = 1.5;      ///< longer triangles are not tried
  double min_edge_m = 0.1;
  std::size_t neighbours = 10;      ///< triangles join a point with its nearest
  std::size_t max_triangles = 400;  ///< of set b that are tried
  std::size_t candidates = 4;       ///< most similar triangles of set a for each
  std::size_t min_pairs = 4;        ///< fewer are no match
  uint64_t seed = 1;
};

struct RigidMatch {
  SE3 T_a_b;
  PointPairs pairs;             ///< (number in a, number in b), ascending in b
  std::size_t second_best = 0;  ///< pairs of the best transform that differs clearly
};

/// Where set b lies in set a, without a prior and without identities [P, Algorithm 1].
///
/// Triangles are listed in both sets; for each of b those of a with the closest edge lengths give a transform (Arun
/// 1987); pairs are counted over all points as in RANSAC. Beyond the paper: edges, pairs and the final fit are weighed
/// by covariances, the best few hypotheses are refined before they are compared, and the runner-up is reported.
/// @return nothing if no transform joins min_pairs points.
/// Cost: about max_triangles x candidates x |a| x |b| distances; 3 ms for 20 x 20 points. Deterministic.
std::optional<RigidMatch> match_points(std::span<const SpacePoint> a, std::span<const SpacePoint> b,
                                       const TriangleMatchOptions& options);

/// Pairs of the two sets under a transform: nearest by Mahalanobis distance first, one to one.
PointPairs pair_points(std::span<const SpacePoint> a, std::span<const SpacePoint> b, const SE3& T_a_b, double slack_m,
                       double max_chi2);

}  // namespace roomcal::tools
