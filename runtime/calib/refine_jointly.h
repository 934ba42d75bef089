#pragma once

#include <span>

#include "runtime/calib/session.h"

namespace roomcal::calib {

using CameraViews = FixedVector<rig::CameraView, kMaxCameras>;
using LidarViews = FixedVector<rig::LidarView, kMaxLidars>;

/// The joint problem of an outcome's located sensors; numbers them on the way (CameraOutcome::view,
/// LidarOutcome::sensor).
struct JointProblemInput {
  CameraViews cameras;
  LidarViews lidars;
  std::size_t reference = rig::kNoReference;

  rig::RigInput input(const Outcome& outcome) const {
    return {cameras.span(), lidars.span(), reference, outcome.landmarks, outcome.plane_cov};
  }
};
void number_sensors(const Session& session, Outcome& outcome, JointProblemInput& joint);

rig::SolveOptions solve_options(const Session& session);

/// Solves for all located sensors; a camera that its markers do not determine is left out and the rest solved again. A
/// LiDAR that the solution moves out of the linear range of its points is located again there.
/// @return kOk or kOutOfMemory.
Status refine_jointly(const Session& session, std::span<const Sweeps> sweeps, Arenas& arenas, Outcome& outcome);

}  // namespace roomcal::calib
