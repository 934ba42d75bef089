#pragma once

#include "runtime/calib/session.h"

namespace roomcal::calib {

/// P(chi-square with 6 degrees of freedom > x): exp(-x/2) (1 + x/2 + x^2/8).
double chi_square_6_tail(double x);

/// Fills outcome.installed: every sensor of the installed record against this shot, and which one has moved.
///
/// Each T_rig_sensor is tested by delta' (cov_installed + cov_now)^-1 delta; directions that a LiDAR does not see carry
/// their covariance and so do not speak. If the smallest p-value, times the number of tests, is below
/// Limits::moved_p_value, something moved. Which one: the sensor without which the others agree best among each other,
/// so that a moved reference is named itself and not all that hang on it. Two sensors alone cannot tell which of them
/// moved; the one that is not the reference is named then.
/// Cost: a 6x6 solve for every pair; no allocation.
void compare_installed(const Session& session, Outcome& outcome);

}  // namespace roomcal::calib
