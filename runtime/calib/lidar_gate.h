#pragma once

#include "runtime/calib/judgement.h"

namespace roomcal::calib {

/// The gates of one LiDAR: located, directions that its sweep does not see, covariance, mounting, beams.
///
/// A direction that is not seen is named. It is a retry where nothing else fixes it; where the mounting carries it, the
/// pose may be written, with the mounting's covariance in that direction, and the operator is told.
void judge_lidar(const LidarSpec& spec, const LidarOutcome& lidar, const Limits& limits, Judgement& judgement);

}  // namespace roomcal::calib
