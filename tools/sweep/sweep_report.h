#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/sweep/load_sweeps.h"

namespace roomcal::tools {

/// What `roomcal sweep --json` writes.
nlohmann::json sweep_json(const std::string& file, const LoadRequest& request, const Recording& recording);

/// The same for people, on stdout.
void print_sweeps(const std::string& file, const LoadRequest& request, const Recording& recording);

}  // namespace roomcal::tools
