#pragma once

#include <string>
#include <vector>

#include "tools/evaluate/paper_runs.h"
#include "tools/evaluate/paper_table.h"

namespace roomcal::tools {

/// One pair over maps of one noise.
struct NoiseRow {
  double map_sigma_m = 0;
  PaperPair pair;                             ///< of all shots in which both sensors were located
  std::vector<double> px;                     ///< length of the reprojection error
  double bound_m = 0;                         ///< stereo rig: RMS over its shots of baseline_bound_m()
  std::string refusal;                        ///< most frequent first reason, numbers left out; empty: none
  int hidden_accepted = 0, hidden_wrong = 0;  ///< of as many shots with maps that do not tell their noise
};

/// The paper's experiments on a noisy map, its four noises and one beyond.
struct NoiseStudy {
  std::vector<NoiseRow> stereo;        ///< stereo rig, cam1 from cam0
  std::vector<NoiseRow> camera_lidar;  ///< robot, lidar0 from cam0
  std::vector<NoiseRow> lidar_lidar;   ///< backpack, lidar1 from lidar0
};
NoiseStudy run_noise_study(const PaperRooms& rooms, int shots);

/// Camera-camera, camera-LiDAR, LiDAR-LiDAR.
std::vector<PaperTable> noise_tables(const NoiseStudy& study);

}  // namespace roomcal::tools
