#pragma once

#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/fixed_text.h"
#include "runtime/calib/device.h"
#include "runtime/map/triangle_index.h"
#include "runtime/pose/locate_camera.h"

namespace roomcal::calib {

/// Why no pose explains what a camera saw, where that can be known: looks once more with ring centres taken for a pixel
/// uncertain and ring sizes left out. If a pose is found then, the room is the right one, and what keeps the markers
/// from fitting is the printed radius, the intrinsics or the map. That pose is for the reason alone: never a result.
///
/// @param observations  as located without success; overwritten.
/// @param step, scratch  given back on return.
/// @return one line with the camera's name and the remedy; empty if nothing is known.
/// Cost: as a location without sizes that fails, a tenth of a second at the most.
Reason explain_misfit(const CameraSpec& camera, std::span<pose::Observation> observations,
                      const map::TriangleIndex& index, Arena& step, Arena& scratch);

}  // namespace roomcal::calib
