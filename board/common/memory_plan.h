#pragma once

#include <cstddef>
#include <string_view>

#include "board/common/capacities.h"
#include "drivers/replay/replay_cursor.h"
#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/calib/memory_plan.h"
#include "runtime/lidar/sweep_builder.h"
#include "runtime/lidar/turntable.h"
#include "runtime/map/room_map.h"
#include "runtime/profile/profile.h"

namespace roomcal::board {

/// One line of the plan.
struct PlanItem {
  FixedText<31> what;
  std::size_t bytes = 0;
};

/// Everything that one device keeps in memory, before anything is reserved. `roomcald --memory-plan` prints it.
struct BoardPlan {
  FixedVector<PlanItem, 40> items;
  calib::MemoryPlan session;
  std::size_t limit_bytes = 0;
  std::size_t total_bytes() const;
};

/// @param map_bytes  of the map's file.
/// @param[out] why  for kCapacity: what the board has no room for, and the remedy.
/// @return kCapacity if the profile asks for more than the board has; `plan` is complete all the same.
Status plan_board(const Capacities& board, const profile::Profile& profile, const calib::Device& device,
                  const map::RoomMap& map, std::size_t map_bytes, const drivers::ReplayCursor& replay, BoardPlan& plan,
                  Reason& why);

/// Points that one sweep of a LiDAR may have on this board; of a profiler on a turntable, one profile.
lidar::SweepOptions sweep_options(const Capacities& board, const profile::LidarProfile& lidar);
lidar::TurntableOptions turntable_options(const Capacities& board, const profile::LidarProfile& lidar);

}  // namespace roomcal::board
