#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/span2d.h"
#include "runtime/base/status.h"
#include "runtime/calib/outcome.h"
#include "runtime/calib/quality_gate.h"
#include "runtime/map/room_map.h"
#include "runtime/map/triangle_index.h"
#include "runtime/ports/clock.h"

namespace roomcal::calib {

/// What the session was armed with. References outlive the session.
struct Session {
  const Device& device;
  const map::RoomMap& map;
  const map::TriangleIndex& index;
  Limits limits;
  /// Per axis, added in quadrature to every ring centre: what the detector cannot see of print, paper and lens. The
  /// remainder that rings of independently rendered rooms show beyond their own covariance.
  double sigma_floor_px = 0.004;
};

/// One shot of images in, judged extrinsics out: detect -> locate cameras -> refine jointly -> judge.
///
/// @param images  one per camera of the device, in its order; an empty view stands for a camera without an image.
/// @param arenas  step is where the outcome's spans live: rewind it before the next shot.
/// @param[out] outcome  always complete: a shot that cannot be calibrated is a verdict with reasons, not an error.
/// @return kInvalidArgument if images and cameras differ in number; kOutOfMemory if the arenas are smaller than
///         plan_memory(): programming errors of the board, not of the room. The outcome is then FAIL_SERVICE.
Status calibrate(const Session& session, std::span<const ImageView> images, const ports::Clock& clock, Arenas& arenas,
                 Outcome& outcome);

}  // namespace roomcal::calib
