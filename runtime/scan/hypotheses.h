#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/base/status.h"
#include "runtime/scan/planes.h"
#include "runtime/scan/range_problem.h"
#include "runtime/scan/surface.h"

namespace roomcal::scan {

/// A pose that would put planes of the sweep on planes of the room, and how well the sweep fits there.
struct Hypothesis {
  SE3 T_room_lidar;
  double score = 0;  ///< mean of capped squares, see score_pose(); 0 is perfect
};

inline constexpr std::size_t kMaxHypotheses = 48;
using Hypotheses = FixedVector<Hypothesis, kMaxHypotheses>;

/// Mean over the rays of the squared range error in units of 5 cm, capped at 1 where the return came from in front of
/// the predicted face (something may stand there) and at 2 where it came from behind it (one does not see through
/// walls); 0.6 where no face is on the way.
/// @param give_up  a score that is no use: what is returned may then be any from there on.
double score_pose(const Surface& surface, std::span<const RayBlock> rays, const SE3& T_room_lidar, double give_up);

/// Coarse poses: every corner of the sweep on every corner of the room, and every edge (two planes) on every edge with
/// the place along it sampled; ray-cast scored, the best kept, near-duplicates dropped.
///
/// @param prior  where there is one, only poses within its gate are made, and the prior itself is added.
/// @param[out] best  best score first.
/// Cost: 10 us a pose; 10 to 20 ms without a prior in a room of ten planes, 1 ms with one.
void find_hypotheses(const Surface& surface, std::span<const RayBlock> probe, const SweepPlanes& planes,
                     const PosePrior* prior, Hypotheses& best);

/// Whether a pose is inside what the prior allows: 6 degrees of freedom, one in 10^5 true poses is not.
bool within_prior(const PosePrior& prior, const SE3& T_room_lidar);

}  // namespace roomcal::scan
