#pragma once

#include <string>

#include "runtime/calib/limits.h"
#include "tools/common/yaml.h"

namespace roomcal::tools {

/// The `limits` of a device.yaml; each of them may be left out and is then as calib::Limits has it:
///
///     limits:
///       min_inliers: 6               # markers without which a camera is not located
///       advise_inliers: 8            # fewer: advised against
///       advise_coverage: 0.2         # share of the image that markers should fill
///       max_outlier_share: 0.3       # of a camera's markers that its pose does not explain
///       min_log_likelihood_gap: 12   # of the best pose over the second-best
///       min_horizon: 0.5             # share of its horizon that a LiDAR must see
///       max_chi2_per_dof: 9          # of the joint solution
///       advise_chi2_per_dof: 3
///       max_held_out_sigmas: 4       # typical miss of markers that took no part
///       advise_held_out_sigmas: 2
///       max_sigma_t_m: 0.003         # 1-sigma of an extrinsic
///       max_sigma_rot_deg: 0.05
///       max_nominal_sigmas: 5        # from the nominal mounting
///       max_intrinsics_sigmas: 5     # of a refined intrinsic parameter from the given one, by intrinsics_sigma
///       moved_p_value: 0.001         # of a false alarm against the installed record
///       advise_beam_sigmas: 4        # of a LiDAR's beam offset
///
/// Strict: an unknown key, a number outside its range, and an advice that could never be given before its limit are
/// errors.
/// @throws ToolError "where:line: limits: ...".
calib::Limits read_limits(const YamlText& yaml, const YAML::Node& node);

/// The section as text, limits that differ from the defaults only; empty if none does.
std::string limits_text(const calib::Limits& limits);

}  // namespace roomcal::tools
