#pragma once

#include "board/common/capacities.h"

namespace roomcal::board {

/// [P]'s stereo rig: two GigE Vision cameras, as the room's survey uses them.
inline constexpr Capacities kStereoRig = {
    .name = "stereo_rig",
    .what = "2 cameras of 1280 x 1024 (GigE Vision, Aravis), hardware or action trigger",
    .cameras = 2,
    .image_bytes = 1280 * 1024,
    .image_slots = 3,
    .limit_bytes = 14 * 1024 * 1024,
};

}  // namespace roomcal::board
