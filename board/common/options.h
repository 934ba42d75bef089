#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "board/common/capacities.h"

namespace roomcal::board {

/// The command line of roomcald.
struct Options {
  const Capacities* board = nullptr;
  std::string folder = "/etc/roomcal";
  std::string console;       ///< empty: the profile's
  std::string state_folder;  ///< empty: where the store is, else the folder
  bool memory_plan = false;
  bool check = false;
  int bench_runs = 0;  ///< 0: no bench
  bool help = false;
  bool version = false;
  std::size_t starve_bytes = SIZE_MAX;
};

/// @param[out] error  one line with the remedy; empty if the line is good.
Options parse_options(int argc, const char* const* argv, std::string& error);
std::string help_text();

}  // namespace roomcal::board
