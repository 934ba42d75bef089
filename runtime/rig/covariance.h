#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/status.h"

namespace roomcal::rig {

/// Joint covariance of n sensors' poses, and of `others` unknowns after them (refined intrinsics): the inverse of their
/// information (row-major, lower blocks), checked.
///
/// @param lidars  how many of the sensors, the last ones, may have open directions: they are not judged here, their
///                covariance says it.
/// @param information  spoilt by the call.
/// @param[out] cov  of the same size; valid only for kOk.
/// @param[out] degenerate_view  number of the camera to blame; set only for kDegenerate.
/// @return kDegenerate if the observations leave some motion of a camera free (least eigenvalue of its information,
///         scaled to a unit diagonal, below 1e-10) or determine it worse than 0.25 m or 0.25 rad.
Status invert_information(std::span<double> information, std::size_t sensors, std::span<double> cov,
                          std::size_t& degenerate_view, std::size_t lidars = 0, std::size_t others = 0);

}  // namespace roomcal::rig
