#pragma once

#include <string>

#include "tools/evaluate/paper_noise.h"

namespace roomcal::tools {

/// Error against map noise as an SVG of three panels: camera-camera with its Cramer-Rao bound, camera-LiDAR,
/// LiDAR-LiDAR; the paper's points in each. Needs no font, script or style from elsewhere.
std::string noise_picture(const NoiseStudy& study);

}  // namespace roomcal::tools
