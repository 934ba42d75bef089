#pragma once

#include <cstddef>

#include "runtime/calib/device.h"
#include "runtime/map/room_map.h"

namespace roomcal::calib {

/// Sizes that a device and a map ask for, bytes; the sum is what the board reserves.
struct MemoryPlan {
  std::size_t permanent_bytes = 0;  ///< triangle index
  std::size_t step_bytes = 0;       ///< detections, correspondences, the joint solution of one shot
  std::size_t scratch_bytes = 0;    ///< the hungriest single call: detector, locator or solver
  std::size_t total_bytes() const { return permanent_bytes + step_bytes + scratch_bytes; }
};

/// Enough for any shot of this device in this room, whatever the images hold.
MemoryPlan plan_memory(const Device& device, const map::RoomMap& map);

}  // namespace roomcal::calib
