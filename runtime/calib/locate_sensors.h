#pragma once

#include "runtime/calib/observer.h"
#include "runtime/calib/session.h"

namespace roomcal::calib {

// The stages of a session up to where every sensor stands in the room. Each fills its part of the outcome; a sensor
// that falls out carries the reason and leaves the others alone. Errors are kOutOfMemory, and kCancelled between two
// sensors if the observer behind `steps` says so.

/// Looks at what came before any time is spent on it.
void preflight(const Session& session, const Shot& shot, Outcome& outcome);
/// The same for rings that were detected elsewhere.
void take_detections(const Session& session, const DetectedShot& shot, Outcome& outcome);

Status detect(const Session& session, std::span<const ImageView> images, Steps& steps, Arenas& arenas,
              Outcome& outcome);
Status locate_cameras(const Session& session, Steps& steps, Arenas& arenas, Outcome& outcome);

/// Every LiDAR from its clean sweeps, with the prior that located cameras and nominal mountings give.
///
/// One that finds no place with the prior is tried without: if the room then has one for it, cameras and LiDAR
/// disagree, and the reason says by how much.
Status locate_lidars(const Session& session, std::span<const Sweeps> sweeps, Steps& steps, Arenas& arenas,
                     Outcome& outcome);

/// The sweeps of one LiDAR that may take part, in the step arena. @return kOk or kOutOfMemory.
Status clean_sweeps(const Sweeps& sweeps, Arena& step, std::span<lidar::Sweep>& clean);

/// One LiDAR from its clean sweeps and a prior (null: none), scan::locate() as it is.
Status locate_sweeps(const Session& session, std::size_t lidar, const Sweeps& sweeps, const scan::PosePrior* prior,
                     Arenas& arenas, scan::Location& location);

}  // namespace roomcal::calib
