#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal calibrate --map M --device D --shot DIR [--json F] [--draw DIR] [--truth F]`: one shot to judged
/// extrinsics. exit_code becomes 2 unless the verdict is PASS or PASS_ADVISE.
void add_calibrate_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
