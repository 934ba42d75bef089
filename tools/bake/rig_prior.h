#pragma once

#include <memory>

#include <ceres/ceres.h>

#include "tools/bake/survey.h"

namespace roomcal::tools {

/// How far the stereo calibration may be off when it is refined along: standard deviations about the given values.
struct RigPrior {
  double focal = 0.003;    ///< relative
  double aspect = 0.0005;  ///< fy / fx, relative
  double principal_px = 5;
  double radial = 0.01;  ///< k1 k2 (k3 k4), each; tangential: a twentieth
  double rotation_rad = 0.003;
  double baseline = 0.003;  ///< relative, along the baseline
  double baseline_across_m = 0.0005;
};

/// On T_right_left (a PoseBlock), about the given one.
std::unique_ptr<ceres::CostFunction> make_extrinsics_prior(const SE3& given_T_right_left, const RigPrior& prior);

/// On a camera's eight intrinsics, about the given ones.
std::unique_ptr<ceres::CostFunction> make_intrinsics_prior(const camera::Intrinsics& given, const RigPrior& prior);

/// A lens given without distortion: its images were undistorted already, and its distortion is not refined.
bool is_undistorted(const camera::Intrinsics& intrinsics);

}  // namespace roomcal::tools
