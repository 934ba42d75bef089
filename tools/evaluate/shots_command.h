#pragma once

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// `roomcal evaluate --shots N [--seed S] [--document F]`, `--rendered N` likewise: clean shots and adverse ones of
/// every kind in random rooms; is what must be accepted accepted, and nothing wrong ever. exit_code becomes 2 below a
/// bar.
/// @param evaluate  has its subcommands already, which these options exclude; something of it all must be there.
void add_evaluate_shots(CLI::App& evaluate, int& exit_code);

}  // namespace roomcal::tools
