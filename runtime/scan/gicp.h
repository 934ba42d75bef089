#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/map/room_map.h"
#include "runtime/math/se3.h"
#include "runtime/scan/kd_tree.h"
#include "runtime/scan/ray_block.h"

namespace roomcal::scan {

/// The densified map [P, III-C]: points on its planes with their normals, and an index; made once before arming.
class GicpTarget {
 public:
  GicpTarget() = default;

  /// From the planes' outlines, see map::sample_surface(). @param spacing_m  0: the map's own.
  /// @return kTooFew (no plane with an outline), kInvalidArgument (a spacing out of range), kOutOfMemory.
  /// Heap: none. Cost: 5 ms for 25,000 points (3 x 4 x 2.7 m at 5 cm).
  static Result<GicpTarget> build(const map::RoomMap& map, double spacing_m, Arena& permanent);
  /// From any cloud, also of a room that is not planar; normals from 20 neighbours each. Not finite points are an
  /// error.
  static Result<GicpTarget> from_cloud(std::span<const Eigen::Vector3f> points_room, Arena& permanent);
  /// Permanent bytes that either takes at most.
  static std::size_t bytes(std::size_t points);

  std::span<const Eigen::Vector3f> points_room() const { return points_room_; }
  std::span<const Eigen::Vector3f> normals_room() const { return normals_room_; }
  const KdTree& tree() const { return tree_; }

 private:
  std::span<Eigen::Vector3f> points_room_, normals_room_;
  KdTree tree_;
};

struct GicpOptions {
  /// Sigma along a surface in sigmas across it: Segal's 1 / sqrt(epsilon) with epsilon 0.001.
  double along_over_across = 31.6;
  double reach_m = 0.5;         ///< of correspondences in the first round
  double final_reach_m = 0.1;   ///< and from where a fifth less a round has led to
  int rounds = 40;              ///< at most
  double converged_m = 2e-5;    ///< a step by less, and by so many radians, is the last
  std::size_t min_pairs = 200;  ///< fewer correspondences in a round are none
};

struct GicpResult {
  SE3 T_room_lidar;
  Mat66 cov =
      Mat66::Zero();  ///< what ranges and beam offsets scatter it by, see register_by_gicp(); right perturbation
  bool converged = false;
  int rounds = 0;
  uint32_t pairs = 0;  ///< of the last round
  double rms_m = 0;    ///< of the last round's distances along the normals
};

/// Points of the sweep that take part, and the scratch that it takes.
inline constexpr std::size_t kGicpPoints = 8192;
std::size_t gicp_scratch_bytes();

/// Generalized ICP, plane to plane, from a coarse pose: minimizes
///     sum rho(e' (C_map + R C_lidar R')^-1 e),  e = R p_lidar + t - p_room of the nearest point of the map,
/// where both covariances are flat discs: across sigma^2 / 2, along that times along_over_across^2.
/// Source: Segal, Haehnel, Thrun, "Generalized-ICP", RSS 2009, equation (2) and section III-B, with Gauss-Newton in
/// place of conjugate gradients, a redescending loss, and normals of the map from its planes.
///
/// It is no match for locate(): no beam offsets, association by nearness, biased at edges; the pull along surfaces
/// holds it where nothing is seen, which no covariance of such a method shows. `cov` is G^-1 S G^-1 with G the normal
/// matrix and S the scatter of the gradient by range noise and by constant offsets of the beams.
///
/// @param scratch  gicp_scratch_bytes().
/// @return kTooFew (usable points, or pairs in some round), kDegenerate (equations without solution), kInvalidArgument,
///         kOutOfMemory; the result is then untouched. kOk also if not converged after `rounds`: see the result.
/// Deterministic, no heap. Cost: about 10 ms for the sweep's normals and 1.5 ms a round.
Status register_by_gicp(const GicpTarget& target, const SweepView& view, const SensorModel& sensor,
                        const SE3& start_T_room_lidar, const GicpOptions& options, Arena& scratch, GicpResult& result);

}  // namespace roomcal::scan
