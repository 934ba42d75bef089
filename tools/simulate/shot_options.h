#pragma once

#include <cstdint>
#include <optional>

#include "runtime/math/types.h"

namespace roomcal::tools {

struct LidarOptions {
  int sweeps = 10;                          ///< whole turns in a recording
  std::optional<double> sigma_m = {};       ///< of one range; none: typical of its kind
  std::optional<double> bias_sigma_m = {};  ///< of what each laser of a unit is off by; none: typical
  double dropout = 0;                       ///< share of firings without a return
  bool mixed_pixels = false;                ///< beams that are cut by an edge return something between
  double tls_step_rad = deg_to_rad(0.5);    ///< of servo and profiler
  /// Azimuths (low, high) from which a spinning LiDAR sees something at 0.5 m only; equal: nothing blocks it.
  double blocked_from_rad = 0, blocked_to_rad = 0;
  bool tls_profiles = false;  ///< also the profiler's own packets and the servo's angles
};

struct ShotOptions {
  uint64_t seed = 1;
  double blur_px = 0.6;      ///< sigma of the lens' point spread
  double motion_px = 0;      ///< uniform motion along x during the exposure
  double defocus_px = 0;     ///< diameter of the disc that a point out of focus becomes
  double vignetting = 0.2;   ///< loss of light at the corner of the image
  double noise_sigma = 2;    ///< grey levels at mid grey
  double exposure = 1;       ///< 1: all but the brightest tenth of the paper is below saturation
  double sigma_rot_deg = 1;  ///< of the true mounting about the nominal one, per axis
  double sigma_t_m = 0.008;
  LidarOptions lidar = {};
  bool imu = false;  ///< with an IMU, at rest
};

}  // namespace roomcal::tools
