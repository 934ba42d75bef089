#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/span2d.h"
#include "runtime/base/status.h"
#include "runtime/calib/observer.h"
#include "runtime/calib/outcome.h"
#include "runtime/calib/quality_gate.h"
#include "runtime/lidar/sweep.h"
#include "runtime/map/room_map.h"
#include "runtime/map/triangle_index.h"
#include "runtime/ports/clock.h"
#include "runtime/scan/surface.h"
#include "runtime/store/record.h"

namespace roomcal::calib {

/// What the session was armed with. References and pointers outlive the session.
struct Session {
  const Device& device;
  const map::RoomMap& map;
  const map::TriangleIndex& index;
  Limits limits;
  /// Per axis, added in quadrature to every ring centre: what the detector cannot see of print, paper and lens. The
  /// remainder that rings of independently rendered rooms show beyond their own covariance.
  double sigma_floor_px = 0.004;
  const scan::Surface* surface = nullptr;    ///< of the map; null only for a device without LiDARs
  const store::Record* installed = nullptr;  ///< the record in force, to compare with; null: none
};

/// The sweeps of one LiDAR in one shot, taken while the device stood still.
using Sweeps = std::span<const lidar::Sweep>;

/// Everything that was grabbed at one press.
struct Shot {
  std::span<const ImageView> images;  ///< one per camera, in the device's order; empty where one is missing
  std::span<const Sweeps> sweeps;     ///< one per LiDAR, in the device's order; empty where none came
};

/// One shot in, judged extrinsics out: detect -> locate cameras -> locate LiDARs -> refine jointly -> judge.
///
/// @param arenas  step is where the outcome's spans live: rewind it before the next shot.
/// @param[out] outcome  always complete: a shot that cannot be calibrated is a verdict with reasons, not an error.
/// @param observer  hears of every step before it is taken and may stop the session there; null: nobody.
/// @return kInvalidArgument if shot and device differ in number, or LiDARs come without a surface; kOutOfMemory if the
///         arenas are smaller than plan_memory(): programming errors of the board, not of the room. The outcome is then
///         FAIL_SERVICE. kCancelled if the observer stopped it: FAIL_RETRY with that as its only reason, and no sensor
///         in the rig.
Status calibrate(const Session& session, const Shot& shot, const ports::Clock& clock, Arenas& arenas, Outcome& outcome,
                 Observer* observer = nullptr);

/// A shot whose rings were detected elsewhere: recorded, or simulated at the level of observations.
struct DetectedShot {
  std::span<const std::span<marker::Detection>> rings;  ///< one per camera, usable ones first; empty: no image
  std::span<const Sweeps> sweeps;
};
Status calibrate(const Session& session, const DetectedShot& shot, const ports::Clock& clock, Arenas& arenas,
                 Outcome& outcome, Observer* observer = nullptr);

}  // namespace roomcal::calib
