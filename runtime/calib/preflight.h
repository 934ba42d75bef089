#pragma once

#include <span>

#include "runtime/base/fixed_text.h"
#include "runtime/base/span2d.h"
#include "runtime/calib/device.h"
#include "runtime/calib/limits.h"
#include "runtime/calib/outcome.h"
#include "runtime/lidar/sweep.h"

namespace roomcal::calib {

/// Grey levels of an image, from some 10,000 of its pixels.
struct Levels {
  int low = 0;   ///< 1 % quantile
  int high = 0;  ///< 99 % quantile
  int mean = 0;
};
Levels sample_levels(ImageView image);

/// Whether an image can be worth looking at, before any time is spent on it.
///
/// @return empty if it can; else one line with the camera's name and the remedy (no image, another size than the
///         intrinsics are for, too dark, too bright, no contrast).
/// Cost: some 10,000 pixels are read, whatever the size.
Reason check_image(const CameraSpec& camera, ImageView image);

/// Whether a sweep may take part: no flag but dropped duplicates.
bool usable(const lidar::Sweep& sweep);

/// The same for a LiDAR's sweeps: fills name, counts, flags, and the failure (no sweep, none without flags, almost no
/// returns, less of the horizon with any than Limits::min_horizon).
/// Cost: some 4000 points are read, whatever the sweeps.
void check_sweeps(const LidarSpec& lidar, std::span<const lidar::Sweep> sweeps, const Limits& limits,
                  LidarOutcome& outcome);

}  // namespace roomcal::calib
