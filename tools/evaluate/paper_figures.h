#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/simulate/devices.h"

namespace roomcal::tools {

// What the paper printed: Fang et al., IROS 2021 [P]. It has no truth; its ground truth is the drawing (CAD).

/// How far two poses of one pair of sensors are apart.
struct PoseDistance {
  double position_m = 0;
  double rotation_rad = 0;
};
PoseDistance distance_between(const SE3& T_a, const SE3& T_b);

/// The paper's one-shot result of a pair (tables III to V), from its drawing; nothing where it printed none.
std::optional<PoseDistance> paper_distance(const PaperDevice& device, const std::string& to, const std::string& from);

/// One row of its experiments with a noisy map; it fails beyond 15 mm.
struct PaperNoiseRow {
  double map_sigma_m = 0;
  double baseline_error_m = 0;  ///< stereo rig, from 120 mm
  double reprojection_px = 0;
  PoseDistance camera_lidar;  ///< robot, lidar0 from cam0, from the drawing
  double lidar_lidar_m = 0;   ///< backpack, lidar1 from lidar0, from the drawing
};
const std::vector<PaperNoiseRow>& paper_noise_rows();
inline constexpr double kPaperNoiseLimit_m = 0.015;

inline constexpr double kPaperMapError_m[] = {0.004, 0.005};  ///< mean over markers, first and second survey
inline constexpr double kPaperPlaneError_m = 0.001;           ///< the smaller of its two mean plane fitting errors
inline constexpr double kPaperCamera_s = 3.797, kPaperLidar_s = 0.855;

/// Its comparison of markers: stereo rig, 2 m, one image.
struct PaperMarkerRow {
  int count = 0;
  double baseline_error_m = 0, baseline_sd_m = 0, reprojection_px = 0;
};
inline constexpr PaperMarkerRow kPaperAprilTags = {100, 0.0001, 0.0013, 0.62};
inline constexpr PaperMarkerRow kPaperRings = {40, 0.0011, 0.0004, 0.31};

}  // namespace roomcal::tools
