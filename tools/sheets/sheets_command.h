#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal sheets`: the markers, to be printed.
void add_sheets_command(CLI::App& app);

}  // namespace roomcal::tools
