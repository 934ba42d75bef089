#pragma once

#include "runtime/calib/locate_sensors.h"

namespace roomcal::calib {

/// A sweep's information as far as it may be believed. Returns that contradict the map come from things that it lacks;
/// where such a thing meets a known wall, some of its returns lie within the robust loss's three sigmas and pull, all
/// to one side. Of a thing of about 0.7 m, a share of 3 sigma / 0.7 m of the returns does so, by 1.5 sigma on average:
/// of n points of which f contradict, that moves the pose by f (3 sigma / 0.7 m) 1.5 sqrt(n) of its own sigmas. With
/// nothing unknown in view, f is 0 and nothing changes.
PoseInformation believed(const scan::Location& location);

/// Fills outcome.landmarks and outcome.plane_cov from the map: the markers with their covariances, and what the error
/// of each does to the plane that was fitted to it.
/// @return kOk or kOutOfMemory. Cost: linear in the markers.
Status collect_map(const Session& session, Arenas& arenas, Outcome& outcome);

/// Fills the pulls of one located LiDAR; none where all planes are exact.
/// @return kOk or kOutOfMemory. Cost: scan::find_face_pulls().
Status collect_pulls(const Session& session, std::size_t lidar, const Sweeps& sweeps, Arenas& arenas, Outcome& outcome);

}  // namespace roomcal::calib
