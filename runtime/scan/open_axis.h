#pragma once

#include <span>

#include "runtime/base/arena.h"
#include "runtime/scan/ray_cast.h"
#include "runtime/scan/refine.h"

namespace roomcal::scan {

/// The axis of position that ranges fix least, and how far along it the sensor may be.
struct OpenAxis {
  Vec3 axis_room = Vec3::UnitZ();
  double sigma_m = 0;
  double reach_m = 0;
  bool open = false;
};

/// @param information  of ranges alone, faces without evidence muted.
/// @param unknown_reach_m  without a prior; with one, three of its sigmas.
OpenAxis open_axis_of(const Mat66& information, const Mat33& R, const PosePrior* prior, double unknown_reach_m);

/// What search_axis() works in.
struct AxisScratch {
  static constexpr std::size_t kPlaces = 5;   ///< where predictions are compared
  static constexpr std::size_t kBlocks = 32;  ///< 2048 rays; if more change, every n-th takes part

  std::span<RayBlock> rays;
  std::span<PosedSurface> posed;

  /// @return kOutOfMemory.
  static Status build(Arena& arena, AxisScratch& scratch);
  static constexpr std::size_t bytes() {
    return kBlocks * sizeof(RayBlock) + kPlaces * sizeof(PosedSurface) + 2 * alignof(RayBlock);
  }
};

/// Looks along an axis for a place that explains the sweep better, and moves the solution there. A strip of floor at a
/// wall's foot that few beams see, or the edge of a pillar, may be all that fixes an axis: descent does not find it
/// from 0.1 m away, and in a sample of the sweep it has hardly a point. So all points take part whose prediction
/// changes along the axis: the cost of each place, a centimetre apart, is theirs.
/// @param[in,out] fine  as refine() left it; moved if a place refines to a lower cost.
/// Cost: five casts of all points and 60 of `rays`, and a refinement where there is a place to try: 2 to 4 ms.
void search_axis(const SweepView& view, const OpenAxis& open, const AxisScratch& scratch, FineSolution& fine,
                 RefineInput& input);

}  // namespace roomcal::scan
