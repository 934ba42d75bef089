#pragma once

#include "board/common/capacities.h"

namespace roomcal::board {

/// [P]'s backpack scanner: four fisheye cameras, two VLP-16.
inline constexpr Capacities kBackpack = {
    .name = "backpack",
    .what = "4 fisheye cameras of 2304 x 3840, 2 LiDARs (VLP-16)",
    .cameras = 4,
    .image_bytes = 2304 * 3840,
    .lidars = 2,
    .sweep_points = 30'000,
    .sweeps = 4,
    .limit_bytes = 104 * 1024 * 1024,
};

}  // namespace roomcal::board
