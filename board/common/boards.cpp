#include "board/common/boards.h"

#include <array>

#include "board/backpack/capacities.h"
#include "board/mobile_robot/capacities.h"
#include "board/sim/capacities.h"
#include "board/stereo_rig/capacities.h"
#include "board/tls/capacities.h"

namespace roomcal::board {

namespace {

constexpr std::array<const Capacities*, 5> kBoards = {&kSim, &kStereoRig, &kTls, &kBackpack, &kMobileRobot};

}  // namespace

std::span<const Capacities* const> known_boards() { return kBoards; }

const Capacities* find_board(std::string_view name) {
  for (const Capacities* board : kBoards)
    if (board->name == name) return board;
  return nullptr;
}

}  // namespace roomcal::board
