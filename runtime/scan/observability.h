#pragma once

#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/math/se3.h"

namespace roomcal::scan {

/// An axis along or about which a sweep does not tell the pose well enough.
struct WeakDirection {
  bool rotation = false;
  Vec3 axis_room = Vec3::UnitZ();  ///< unit; the sign means nothing
  double sigma = 0;                ///< m or rad; kUnseenSigma: not seen at all
};
using WeakDirections = FixedVector<WeakDirection, 6>;

/// What the covariance of an axis that nothing fixes is capped at: a room is that large.
inline constexpr double kUnseenSigma_m = 1.0;
inline constexpr double kUnseenSigma_rad = 0.5;

struct ObservabilityLimits {
  double sigma_m = 0.001;     ///< a third of what a calibration may be off
  double sigma_rad = 0.0003;  ///< likewise: 0.017 degree
};

/// Covariance of a pose from its information alone; axes without information get the unseen sigmas.
Mat66 covariance_of(const Mat66& information);

/// Principal axes of position and of rotation whose sigma is above the limit, worst first in each.
/// @param information  of right perturbations of T_room_lidar.
WeakDirections find_weak_directions(const Mat66& information, const Mat33& R_room_lidar,
                                    const ObservabilityLimits& limits);

/// "height not seen, 1-sigma 140 mm": axes by their names in a room with z up.
FixedText<96> describe(const WeakDirection& weak);

}  // namespace roomcal::scan
