#pragma once

#include "runtime/scan/candidates.h"
#include "runtime/scan/print_fit.h"
#include "runtime/scan/refine.h"

/// What the reflectivity of the printed sheets decides where ranges do not.
namespace roomcal::scan {

/// Keeps the twin whose view of the prints matches, if one clearly does.
/// @return false if prints should tell, and none of the places matches them: the right one may not be among them.
/// Cost: 1 to 2 ms a twin.
bool tell_twins_apart(const SweepView& view, const RefineInput& input, PrintMatcher& matcher, CandidateSet& candidates);

/// What the prints measured, as information on the pose: J xi = 0 at the moved pose, with
///     J = (R' a, c x R' a),  a: the axis,  c: where the prints are in the sensor's frame.
struct PrintMeasurement {
  Vec6 J = Vec6::Zero();
  double weight = 0;  ///< 1 / m^2; 0: none
  uint32_t points = 0;
};

/// Measures an axis that ranges leave open by the prints, and solves again with it.
/// @param[in,out] fine  the solution; moved if the prints say where.
/// Cost: 2 to 6 ms where an axis is open.
PrintMeasurement close_axis(const SweepView& view, PrintMatcher& matcher, RefineInput input, FineSolution& fine);

}  // namespace roomcal::scan
