#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal evaluate rings`: which printed ring ratios the detector sees best.
void add_evaluate_rings(CLI::App& evaluate);

}  // namespace roomcal::tools
