#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal sweep`: decodes a recording and says what is in it.
void add_sweep_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
