#pragma once

#include <cstdint>
#include <span>

#include "runtime/scan/range_problem.h"

namespace roomcal::scan {

/// What a refinement works on.
struct RefineInput {
  const Surface& surface;
  const SensorModel& sensor;
  const PosePrior* prior = nullptr;  ///< takes part as a measurement; null: none
  double sigma_m = 0.015;            ///< of one range, as the sweep shows it
  uint64_t mute = 0;                 ///< bits of faces whose points carry no weight
};

/// One Gauss-Newton step from the sums gathered at `state`; damping adds that share to the diagonal.
/// @return the step's length in sigmas; negative if the equations could not be solved, `state` is then unchanged.
double step_state(const RangeSums& sums, const RefineInput& input, RangeState& state, double damping = 0);

/// Brings a coarse pose (0.3 m, 10 degrees) to the optimum of a sample: the robust loss narrows from 0.35 m to 3
/// sigmas. Cost: 0.15 ms for 600 rays.
void settle(std::span<const RayBlock> sample, const RefineInput& input, double reach_m, RangeState& state);

/// Four rounds at most with the loss at 3 sigmas: the end of settle(), for a pose that is right but for millimetres.
void settle_near(std::span<const RayBlock> sample, const RefineInput& input, RangeState& state);

/// A solution over all points.
struct FineSolution {
  RangeState state;
  RangeSums sums;            ///< of all points, gathered within a third of a sigma of the state
  RangeState linearized_at;  ///< the state that they were gathered at
  /// Whether the last step was below a third of a sigma: returns near edges change sides from round to round, and steps
  /// do not shrink to nothing.
  bool converged = false;
};

/// The optimum over all points, from a settled state: first over every fifth, then over all. Faces that the sweep gives
/// no evidence for are muted on the way.
/// @param[in,out] input  `mute` is what was found to carry no evidence.
/// Cost: two or three passes over all points of some 15 ns each, and a few over a fifth.
void refine(const SweepView& view, RefineInput& input, FineSolution& fine);

/// The same over all points from the start: where few of them count.
void refine_fully(const SweepView& view, RefineInput& input, FineSolution& fine);

/// Robust cost of a state, sigmas^2: all usable points, those without a prediction at kUnmappedLoss, and the prior.
double cost_of(const RangeSums& sums, const RefineInput& input, const RangeState& state);

/// Spread of the ranges around the surface: 1.48 x the median of the residuals that belong to it, at least the sensor's
/// own sigma; up to a fifth more counts as the sensor's.
/// @param scratch  one float for each ray.
double spread_m(std::span<const RayBlock> sample, const RefineInput& input, const RangeState& state,
                std::span<float> scratch);

/// Mean robust loss of a state over the usable rays, sigmas^2; rays that meet nothing count as far off. About 1 where
/// all is right, at most 27.
double mean_loss(const RangeSums& sums);

/// Bits of faces whose points are no evidence for them: the plane behind, continued, explains the returns as well. A
/// pose that is off along an axis which the sweep does not see lets some beams graze the floor by mistake; believed,
/// they would fix the height, to a millimetre and wrongly.
/// @param sums  gathered with PassOptions::evidence: from a sample for where to look, from all for what to believe.
uint64_t faces_without_evidence(const RangeSums& sums);

}  // namespace roomcal::scan
