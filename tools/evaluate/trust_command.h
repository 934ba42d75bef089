#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal evaluate trust [--shots N] [--refine-intrinsics] [--map-noise MM...] [--join N] [--json F]`: does verify
/// name the sensor that moved, are the covariances honest. exit_code becomes 2 below a bar.
void add_evaluate_trust(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
