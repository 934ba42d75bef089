#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal map import | info | noise`.
void add_map_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
