#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal report RESULT [--shot DIR] [--map M] [--installed F] [--truth F] -o page.html`: a calibration as one page.
/// exit_code stays 0 whatever the verdict: the page tells it.
void add_report_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
