#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal plan`: where to put how many sheets.
void add_plan_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
