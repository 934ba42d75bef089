#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tools/bake/survey.h"

namespace roomcal::tools {

/// Reads what `roomcal bake` takes: a folder of image pairs, the paper's map file, or detections saved before.
///
/// - Folder: `cam0/` and `cam1/` (or `left/` and `right/`) with PNG, JPEG or PGM. Images of one name are a pair; order
///   is natural (9 before 10). An image without partner is left out and named.
/// - `*.yaml`: the key points of all key-frames of the paper's file; its poses, indices and identities are not read.
/// - `*.json`: what `--save-detections` wrote (survey_json.h).
/// @throws ToolError naming what is missing or does not fit the calibration.
Survey read_survey(const std::filesystem::path& path, const StereoRig& rig);

/// Image files of the two sides, paired by name in natural order.
/// @param[out] remarks  one line for each image without a partner.
std::vector<std::pair<std::filesystem::path, std::filesystem::path>> pair_images(const std::filesystem::path& folder,
                                                                                 std::vector<std::string>& remarks);

/// 9 before 10: runs of digits compare as numbers.
bool natural_less(const std::string& a, const std::string& b);

}  // namespace roomcal::tools
