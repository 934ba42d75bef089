#pragma once

#include <span>
#include <string_view>

#include "board/common/capacities.h"

namespace roomcal::board {

/// Every product that this program can be.
std::span<const Capacities* const> known_boards();

/// @return nullptr if there is none of that name.
const Capacities* find_board(std::string_view name);

}  // namespace roomcal::board
