#pragma once

#include <cstddef>
#include <string_view>

namespace roomcal::board {

/// What one product has room for. Everything else follows: the memory plan, and what a profile may ask for.
struct Capacities {
  std::string_view name;
  std::string_view what;  ///< one line, for --help
  std::size_t cameras = 0;
  std::size_t image_bytes = 0;  ///< width x height of the largest camera
  std::size_t image_slots =
      2;  ///< of every camera: one that is taken, one that is looked at; more for free running ones
  std::size_t lidars = 0;
  std::size_t sweep_points = 0;           ///< of one sweep
  std::size_t sweeps = 0;                 ///< of one LiDAR in one shot
  std::size_t map_bytes = 96 * 1024;      ///< of the room's map: 60 kB for 340 markers
  std::size_t camera_stack = 128 * 1024;  ///< the least that the C library takes on aarch64
  std::size_t lidar_stack = 128 * 1024;
  std::size_t press_stack = 256 * 1024;
  std::size_t limit_bytes = 0;  ///< of the one block; a profile that wants more is refused
};

}  // namespace roomcal::board
