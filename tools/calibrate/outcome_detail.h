#pragma once

#include <nlohmann/json.hpp>

#include "runtime/calib/session.h"

namespace roomcal::tools {

/// What `--detail` adds to the result of `roomcal calibrate`, for those who look into one shot:
/// - of every camera `rings`: all that were seen (detection_json.h; `cov_px2` with what the lens leaves), and of the
///   inliers also `marker` (id), `predicted_px` (the map's marker in the solution), `residual_cov_px2` (what predicted
///   less seen may scatter by: ring, floor, map) and `held_out`;
/// - of every sensor with a drawing `nominal` {T_rig_sensor, sigma_t_m, sigma_rot_rad};
/// - `joint_covariance` {sensors, matrix}: of all T_rig_sensor together, 6 rows a sensor, the reference left out.
void add_detail(const calib::Session& session, const calib::Outcome& outcome, nlohmann::json& result);

}  // namespace roomcal::tools
