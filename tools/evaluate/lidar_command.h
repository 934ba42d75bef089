#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal evaluate lidar`: the location of simulated sweeps against the Cramer-Rao bound.
/// @param evaluate  the `evaluate` command; @param exit_code becomes 2 if a bar is not met.
void add_evaluate_lidar(CLI::App& evaluate, int& exit_code);

}  // namespace roomcal::tools
