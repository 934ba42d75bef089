#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace roomcal::tools {

/// Check of a command-line option: a finite number from `low` to `high`, both included.
/// CLI11's own Range lets NaN pass, because it only asks whether a value is outside.
/// @param unit  for the message; may be empty.
CLI::Validator number_between(double low, double high, const std::string& unit = "");

}  // namespace roomcal::tools
