#pragma once

#include "runtime/math/se3.h"
#include "tools/common/random.h"
#include "tools/simulate/devices.h"
#include "tools/simulate/scene.h"

namespace roomcal::tools {

/// T_room_cam of a device's reference camera where somebody may have put it. In a box: the middle part of the room; a
/// narrow camera near one of its ends, looking across. In a room of other layout: anywhere off the walls, a narrow
/// camera looking where the room is deep.
/// @throws ToolError if there is no free place.
SE3 draw_place(const Scene& scene, const PaperDevice& device, Random& random);

}  // namespace roomcal::tools
