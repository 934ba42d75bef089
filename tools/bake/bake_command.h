#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal bake SURVEY --stereo CALIB -o M.room`.
void add_bake_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
