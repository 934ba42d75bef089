#pragma once

#include <string>

#include "tools/bake/survey.h"

namespace roomcal::tools {

/// Detections of a survey as a file, so that images are searched once (`--save-detections`):
///
///     {"format": "roomcal-survey-1", "resolution_px": [[1280, 1024], [1280, 1024]],
///      "pairs": [{"name": "000000", "left": [...], "right": [...]}]}
///
/// with a sighting as [x, y] or [x, y, cov_xx, cov_xy, cov_yy] or these and [major_px, minor_px, angle_rad,
/// ellipse_x, ellipse_y] behind.
std::string to_survey_json(const Survey& survey, const StereoRig& rig);

/// @throws ToolError "name: ..." for what is not this format or of another resolution than the calibration.
Survey parse_survey_json(const std::string& name, const std::string& text, const StereoRig& rig);

}  // namespace roomcal::tools
