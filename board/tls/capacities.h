#pragma once

#include "board/common/capacities.h"

namespace roomcal::board {

/// [P]'s terrestrial laser scanner: a 2-D profiler turned by a servo, two still cameras.
inline constexpr Capacities kTls = {
    .name = "tls",
    .what = "2 still cameras of 4608 x 3456, a 2-D profiler on a CAN servo",
    .cameras = 2,
    .image_bytes = 4608 * 3456,
    .lidars = 1,
    .sweep_points = 1'000'000,
    .sweeps = 1,
    .limit_bytes = 160 * 1024 * 1024,
};

}  // namespace roomcal::board
