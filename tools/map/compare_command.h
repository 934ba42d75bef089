#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal map compare A B [--json F] [--gate MM]`; exit 2 if the maps have nothing in common.
void add_map_compare(CLI::App& map, int& exit_code);

}  // namespace roomcal::tools
