#pragma once

#include "board/common/capacities.h"

namespace roomcal::board {

/// [P]'s mobile robot: four wide-angle cameras, one VLP-16, CAN.
inline constexpr Capacities kMobileRobot = {
    .name = "mobile_robot",
    .what = "4 cameras of 1280 x 720 (V4L2), 1 LiDAR (VLP-16), CAN standstill",
    .cameras = 4,
    .image_bytes = 1280 * 720,
    .image_slots = 3,
    .lidars = 1,
    .sweep_points = 30'000,
    .sweeps = 4,
    .limit_bytes = 24 * 1024 * 1024,
};

}  // namespace roomcal::board
