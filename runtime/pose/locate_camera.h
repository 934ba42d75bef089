#pragma once

#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/camera/camera.h"
#include "runtime/map/triangle_index.h"
#include "runtime/math/se3.h"

namespace roomcal::pose {

/// One ring centre as the locator wants it. The ellipse is optional (0 = not known): it only prunes candidates.
struct Observation {
  Vec2 centre_px = Vec2::Zero();
  Mat22 cov_px2 = Mat22::Identity();
  double major_px = 0;  ///< full axes of the outer circle's ellipse
  double minor_px = 0;
  double angle_rad = 0;  ///< from +x to the major axis towards +y
};

/// Observation number and map marker number that belong together.
struct Correspondence {
  uint16_t observation = 0;
  uint16_t marker = 0;
};

struct LocateOptions {
  int min_inliers = 6;                   ///< fewer never pass
  double min_inlier_ratio = 0.5;         ///< of the observations; clutter and unmapped markers make up the rest
  double gate_px = 3.0;                  ///< floor of the inlier gate; widened by the map's and the centre's covariance
  double min_log_likelihood_gap = 12.0;  ///< best against second-best pose; below: ambiguous
  double max_sigma_m = 0.05;             ///< a pose that the rings tell worse in any direction is kDegenerate
  double max_sigma_rad = deg_to_rad(1.0);
  /// The same with the map's errors. Wider: cameras that see the same markers share these, and their extrinsics are
  /// better than their places; a joint solution takes poses of up to 0.25 m.
  double max_map_sigma_m = 0.2;
  double max_map_sigma_rad = deg_to_rad(4.0);
  /// Log of the odds against an accepted pose being chance, after all hypotheses that were tried.
  double min_log_odds = 14.0;
  uint32_t seed = 1;
  int max_hypotheses = 1000000;  ///< bounds the time: about 0.4 us each
};

/// A camera in the room, with what a judge needs to believe it.
struct CameraLocation {
  SE3 T_room_cam;
  Mat66 cov = Mat66::Zero();          ///< of T_room_cam, right perturbation (m, rad); map errors count as independent
  std::span<Correspondence> inliers;  ///< lives in the step arena, by observation number
  double rms_px = 0;                  ///< of the inliers' reprojection residuals, both axes
  double coverage = 0;                ///< fraction of the 4 x 4 image cells that hold an inlier
  double log_odds = 0;                ///< pose against chance, all hypotheses counted
  bool has_second = false;
  SE3 T_room_cam_second;            ///< the best pose that is clearly another one
  double log_likelihood_gap = 1e9;  ///< log L(best) - log L(second); 1e9 without a second
  int hypotheses = 0;               ///< minimal solutions that were verified
};

/// Scratch that locate_camera() needs, bytes, for any outcome.
std::size_t locate_scratch_bytes(std::size_t observations);
/// Step bytes that it leaves behind.
std::size_t locate_step_bytes(std::size_t observations);

/// Where the camera is, from ring centres without identity and a map; no prior.
///
/// [P, III-B]: Delaunay triangles of the bearings, AP3P on the map's triangle index, RANSAC, polish on all inliers.
/// Where the observations have ellipses and the map a common radius, each triangle's edges are known to a few percent
/// and pick the candidates; without them every triple is tried, the most probable first.
/// @param index  of the map in use, built on arming.
/// @param[out] location  filled if kOk, and as far as known if kAmbiguous or kDegenerate; cleared otherwise.
/// @return kTooFew (fewer than min_inliers observations), kNotFound (no pose explains enough of them), kAmbiguous
///         (another pose explains them as well), kDegenerate (the inliers do not determine a pose), kInvalidArgument
///         (an observation is not finite), kOutOfMemory.
/// Deterministic for a seed; bounded by max_hypotheses; no allocation outside the arenas.
/// Cost: below 1 ms with ellipses, a few ms without, more where it refuses.
Status locate_camera(const camera::Camera& camera, std::span<const Observation> observations,
                     const map::TriangleIndex& index, const LocateOptions& options, Arena& step, Arena& scratch,
                     CameraLocation& location);

}  // namespace roomcal::pose
