#pragma once

#include <filesystem>

#include "tools/plan/plan.h"

namespace roomcal::tools {

/// A PDF, A4: first what to do and how many sheets go where, then every wall to scale with its sheets, and their places
/// in centimetres from the wall's left and lower edge.
/// @throws ToolError naming the path if it cannot be written.
void write_drawing(const Plan& plan, const PlanOptions& options, const std::filesystem::path& path);

}  // namespace roomcal::tools
