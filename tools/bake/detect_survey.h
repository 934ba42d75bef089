#pragma once

#include <filesystem>
#include <utility>
#include <vector>

#include "tools/bake/survey.h"

namespace roomcal::tools {

/// Finds the rings in every image of a survey with the runtime's detector, on all processors; results do not depend on
/// how many there are. Unreadable images are remarked and count as empty.
/// @throws ToolError for an image of another size than its camera's calibration.
Survey detect_survey(const std::vector<std::pair<std::filesystem::path, std::filesystem::path>>& pairs,
                     const StereoRig& rig);

}  // namespace roomcal::tools
