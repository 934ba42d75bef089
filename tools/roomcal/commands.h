#pragma once

#include <CLI/CLI.hpp>

#include "tools/bake/bake_command.h"
#include "tools/calibrate/calibrate_command.h"
#include "tools/detect/detect_command.h"
#include "tools/device/import_command.h"
#include "tools/evaluate/evaluate_command.h"
#include "tools/export/export_command.h"
#include "tools/imu/imu_command.h"
#include "tools/map/map_command.h"
#include "tools/plan/plan_command.h"
#include "tools/provision/provision_command.h"
#include "tools/report/report_command.h"
#include "tools/sheets/sheets_command.h"
#include "tools/simulate/simulate_command.h"
#include "tools/sweep/sweep_command.h"

namespace roomcal::tools {

// Each add_<noun>_command (in tools/<noun>/<noun>_command.h) puts its subcommand into the program and works from its
// callback. A callback throws ToolError for what the user must mend (exit 1) and sets exit_code for a verdict that is
// not PASS (exit 2).

/// All of them, in the order of `roomcal --help`.
inline void add_commands(CLI::App& app, int& exit_code) {
  add_bake_command(app, exit_code);
  add_calibrate_command(app, exit_code);
  add_detect_command(app, exit_code);
  add_evaluate_command(app, exit_code);
  add_export_command(app, exit_code);
  add_import_command(app, exit_code);
  add_imu_command(app, exit_code);
  add_map_command(app, exit_code);
  add_plan_command(app, exit_code);
  add_provision_command(app, exit_code);
  add_record_command(app, exit_code);
  add_report_command(app, exit_code);
  add_sheets_command(app);
  add_simulate_command(app, exit_code);
  add_sweep_command(app, exit_code);
  add_verify_command(app, exit_code);
}

}  // namespace roomcal::tools
