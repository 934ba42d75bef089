#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal detect IMAGE... [--json F] [--draw DIR]`: ring markers of single images.
void add_detect_command(CLI::App& app, int& exit_code);

}  // namespace roomcal::tools
