#pragma once

#include "runtime/math/se3.h"

namespace roomcal {

/// What measurements say about one pose, as a quadratic around a point; everything else they depend on (beam offsets)
/// is already eliminated. With T = T_hat * se3_exp(xi):
///
///     cost(xi) = chi2 - 2 gradient . xi + xi' information xi      (whitened squares)
///
/// A joint problem adds `information` and `gradient` to its own normal equations of that pose (information * xi =
/// gradient), and asks for a new one when its pose has moved: relinearized, never extrapolated. Singular if the
/// measurements leave an axis open: that is how weak directions stay weak in a joint solution.
struct PoseInformation {
  SE3 T_hat;                          ///< where it was linearized
  Mat66 information = Mat66::Zero();  ///< right perturbation (m, rad), positive semi-definite
  Vec6 gradient = Vec6::Zero();       ///< zero at the measurements' own optimum
  double chi2 = 0;                    ///< at T_hat, robustly weighted
  int measurements = 0;               ///< that carry weight
};

}  // namespace roomcal
