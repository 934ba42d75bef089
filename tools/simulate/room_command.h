#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal simulate room`: a random room as files.
void add_room_command(CLI::App& simulate);

}  // namespace roomcal::tools
