#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal evaluate paper`: the paper's experiments on the simulator, with truth, beside the paper's figures.
/// @param exit_code  becomes 2 if a row is worse than the paper's or a wrong extrinsic would be written.
void add_evaluate_paper(CLI::App& evaluate, int& exit_code);

}  // namespace roomcal::tools
