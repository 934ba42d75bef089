#pragma once

#include "board/common/capacities.h"

namespace roomcal::board {

/// The mobile robot of the simulator: replayed images and packets, everything else real.
inline constexpr Capacities kSim = {
    .name = "sim",
    .what = "no hardware: replays the simulator's shots of a mobile robot",
    .cameras = 4,
    .image_bytes = 1280 * 720,
    .lidars = 1,
    .sweep_points = 30'000,
    .sweeps = 3,
    .limit_bytes = 24 * 1024 * 1024,
};

}  // namespace roomcal::board
