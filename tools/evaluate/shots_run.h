#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "tools/evaluate/shot_kind.h"
#include "tools/evaluate/shot_result.h"

namespace roomcal::tools {

using ShotTallies = std::array<ShotTally, kShotKinds.size()>;

inline constexpr std::size_t kShotRooms = 24;

/// `shots` of them at the level of observations: a fifth clean, the others of all kinds in turn, each in one of the
/// rooms, a place and a device of its own. The same seed gives the same shots, whatever the number of cores.
/// @param rooms  from 2
/// @param so_far  is called at every thousand, and at the end, with what a run of so many shots gives
/// Cost: about a second of one core a room, 0.3 s a shot.
ShotTallies run_observed_shots(uint64_t seed, int shots, std::size_t rooms = kShotRooms,
                               const std::function<void(int, const ShotTallies&)>& so_far = nullptr);

/// The same shots at both levels.
struct RenderedTallies {
  ShotTallies rendered, observed;
};
/// `shots` of each of these kinds through images and packets, and again at the level of observations. Every 25 share a
/// room.
/// @param so_far  is called at every 25, and at the end, with the first so many of each kind
/// Cost: about a second of one core a clean shot; where no camera is located, the search for markers takes far longer.
RenderedTallies run_rendered_shots(uint64_t seed, int shots, std::span<const ShotKind> kinds = kShotKinds,
                                   const std::function<void(int, const RenderedTallies&)>& so_far = nullptr);

}  // namespace roomcal::tools
