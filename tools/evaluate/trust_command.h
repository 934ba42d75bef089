#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal evaluate trust [--shots N] [--refine-intrinsics] [--map-noise MM...] [--join N] [--no-traps] [--json F]`:
/// does verify name the sensor that moved, does a shot that must not be believed get refused, are the covariances
/// honest. exit_code becomes 2 below a bar.
void add_evaluate_trust(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
