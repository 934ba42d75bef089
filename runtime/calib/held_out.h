#pragma once

#include "runtime/calib/session.h"

namespace roomcal::calib {

/// Orders a camera's rings so that those of every fifth marker of the map come last. A camera that would be left with
/// too few keeps them all.
void hold_out_last(CameraOutcome& camera);

/// Solves once more without the held-out markers and predicts them: fills outcome.held_out.
///
/// A held-out ring is missed by r = project(T_cam_room p) - centre with the predicted covariance
/// cov_centre + J_pose cov_pose J_pose^T + J_point cov_point J_point^T, and that of the lens where it was refined. The
/// median of r' cov^-1 r is told in sigmas, so that a few outliers do not speak for all.
/// @return kOk, also where there is nothing to predict; kOutOfMemory. Cost: two rounds of the joint solution.
Status predict_held_out(const Session& session, Arenas& arenas, Outcome& outcome);

}  // namespace roomcal::calib
