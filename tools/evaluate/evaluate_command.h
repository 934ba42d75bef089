#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal evaluate ...`: what the parts achieve, against the bars that they have to meet. Exit 2 below a bar.
void add_evaluate_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
