#pragma once

#include <span>

#include "runtime/base/status.h"
#include "runtime/rig/camera_rig.h"

namespace roomcal::rig {

/// Whether solve_rig() can work with its arguments at all.
/// @return kOk, kInvalidArgument or kCapacity, with the reason.
Status check_inputs(const RigInput& input, const SolveOptions& options);

/// L (3x3, lower) with L L^T = cov for a positive semi-definite covariance; zero columns where it has no extent.
/// @return false if cov is not finite, not symmetric or has a negative direction; L is then not set.
bool covariance_root(const Mat33& cov, Mat33& L);

/// W (2x2, lower) with W^T W = cov^-1 up to rotation, so that W r is white: the inverse of the Cholesky factor.
/// @return false if cov is not finite or not positive definite; W is then not set.
bool whitening(const Mat22& cov, Mat22& W);

}  // namespace roomcal::rig
