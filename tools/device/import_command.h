#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal import kalibr camchain.yaml [--nominal nominal.json] -o device.yaml`.
void add_import_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
