#pragma once

#include <cstddef>

#include "runtime/math/types.h"

namespace roomcal::calib {

/// Every limit that a verdict rests on, in one table; `limits` in device.yaml sets them by these names.
struct Limits {
  /// A camera with fewer markers than this that agree on a pose is not located.
  std::size_t min_inliers = 6;
  /// A pose from fewer markers than this is believed but advised against: one wrong marker then moves it visibly.
  std::size_t advise_inliers = 8;
  /// Inliers crowded into less of the image than this leave the pose weak across the crowd.
  double advise_coverage = 0.2;
  /// Log likelihood by which the best pose of a camera must beat the second-best, else the room has two places for it.
  double min_log_likelihood_gap = 12.0;
  /// Share of its horizon that a LiDAR must see: no room looks like less, unless the device itself stands in its view.
  double min_horizon = 0.5;
  /// Share of usable detections that the pose does not explain, above which something in the room has changed.
  double max_outlier_share = 0.3;
  /// chi2 per degree of freedom of the joint solution above which the model is wrong: intrinsics, map or sync.
  /// Wide, because clean shots sit near 1 and a camera that moved within the exposure sits in the hundreds.
  double max_chi2_per_dof = 9.0;
  double advise_chi2_per_dof = 3.0;
  /// 1-sigma of an extrinsic, above which it is not worth storing.
  double max_sigma_t_m = 0.003;
  double max_sigma_rot_rad = 0.05 * kPi / 180.0;
  /// Distance from the nominal mounting in its own sigmas, per axis, above which a sensor sits where it should not.
  double max_nominal_sigmas = 5.0;
  /// Of a refined camera parameter from its given value in that one's sigmas, above which these are not its intrinsics.
  double max_intrinsics_sigmas = 5.0;
  /// Typical miss of markers that took no part, in predicted sigmas: 1 is clean; what the map or the intrinsics hide
  /// from the fit shows here.
  double advise_held_out_sigmas = 2.0;
  double max_held_out_sigmas = 4.0;
  /// Probability, over all sensors of a shot, of calling a sensor moved that has not.
  double moved_p_value = 0.001;
  /// Beam offset in sigmas of the data sheet's, from which a LiDAR's health is worth a word.
  double advise_beam_sigmas = 4.0;
};

}  // namespace roomcal::calib
