#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal evaluate detector`: the ring detector against its Cramer-Rao bound, over size, slant, light and noise.
/// @param evaluate  the `evaluate` command; @param exit_code becomes 2 if a bar is not met.
void add_evaluate_detector(CLI::App& evaluate, int& exit_code);

}  // namespace roomcal::tools
