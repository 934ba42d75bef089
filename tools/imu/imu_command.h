#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal imu --result R.json --samples IMU.csv ... [--drawing ROLL PITCH YAW] [--truth F] [--json F]`: how an IMU is
/// turned on the rig, from gravity in as many stances as there are results. exit_code becomes 2 if an axis is neither
/// seen nor carried by a drawing.
void add_imu_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
