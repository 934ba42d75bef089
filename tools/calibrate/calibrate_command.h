#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal calibrate --map M --device D --shot DIR [--json F] [--draw DIR] [--sweeps N] [--installed F] [--dry-run]`:
/// one shot to judged extrinsics. exit_code becomes 2 unless the verdict is PASS or PASS_ADVISE.
void add_calibrate_command(CLI::App& app, int& exit_code);

/// `roomcal verify --map M --device D --shot DIR --installed FILE`: the same flow, writes no record; exit_code becomes
/// 2 unless the verdict may be written and no sensor has moved since the installed record.
void add_verify_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
