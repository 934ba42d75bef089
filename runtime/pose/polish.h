#pragma once

#include <span>

#include "runtime/base/status.h"
#include "runtime/math/se3.h"
#include "runtime/pose/support.h"

namespace roomcal::pose {

/// A pose refined on its inliers.
struct PolishedPose {
  SE3 T_room_cam;
  Mat66 cov = Mat66::Identity();  ///< right perturbation (m, rad)
  Support support;
};

/// Robust Gauss-Newton on the sphere: minimizes  sum huber(|tangent^T T_room_cam^-1 p / range|^2_cov)  [P, III-B step
/// 4].
///
/// @param marker_of_sight  the matches; kNoMarker entries take no part.
/// @param[in,out] T_room_cam  start and result; untouched on failure.
/// @param[out] cov  inverse of the normal matrix, the map's covariance taken as independent noise of each marker.
/// @return kTooFew (below three matches), kDegenerate (the normal matrix is singular).
Status refine_pose(const SightSet& set, const map::TriangleIndex& index, std::span<const uint16_t> marker_of_sight,
                   int iterations, SE3& T_room_cam, Mat66& cov);

/// Covariance that a pose would have if the map were exact: what the rings in view and their geometry tell.
/// @return not finite where they determine no pose.
Mat66 covariance_of_rings(const SightSet& set, const map::TriangleIndex& index,
                          std::span<const uint16_t> marker_of_sight, const SE3& T_room_cam);

/// Match and refine in turn with a shrinking gate, from a minimal solution to the final inliers.
///
/// @param[out] marker_of_sight  the final matches. @param work  as long as the sights.
/// @return as refine_pose().
Status polish(const Matcher& matcher, const SE3& T_room_cam_start, std::span<uint16_t> marker_of_sight,
              std::span<double> work, PolishedPose& pose);

}  // namespace roomcal::pose
