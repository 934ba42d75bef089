#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal simulate room|shot`: a random room, and shots of one of the paper's devices in it, with the truth.
void add_simulate_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
