#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal simulate shot`: what a device's sensors see in such a room, with the truth.
void add_shot_command(CLI::App& simulate);

}  // namespace roomcal::tools
