#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal provision device.yaml -o FOLDER [--factory RECORD]`: checks the device and writes what its program reads:
/// FOLDER/device.profile and FOLDER/factory.record (the nominal mounting, or a record that was measured).
void add_provision_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
