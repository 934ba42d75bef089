#pragma once

#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/camera/camera.h"
#include "runtime/map/room_map.h"
#include "runtime/math/se3.h"

namespace roomcal::pose {

/// One ring centre as the locator wants it. Diameter is optional (0 = not known): it only prunes candidates.
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
  uint32_t seed = 1;
  int max_hypotheses = 200000;  ///< bounds the time
};

/// A camera in the room, with what a judge needs to believe it.
struct CameraLocation {
  SE3 T_room_cam;
  Mat66 cov;                          ///< of T_room_cam, right perturbation (m, rad); map taken as exact
  std::span<Correspondence> inliers;  ///< lives in the step arena
  double rms_px = 0;                  ///< of the inliers' reprojection residuals
  double coverage = 0;                ///< fraction of the 4 x 4 image cells that hold an inlier
  bool has_second = false;
  SE3 T_room_cam_second;          ///< the best pose that is clearly another one
  double log_likelihood_gap = 0;  ///< log L(best) - log L(second); infinity-like (1e9) without a second
  int hypotheses = 0;             ///< minimal solutions that were verified
};

/// Scratch that locate_camera() needs, bytes.
std::size_t locate_scratch_bytes(std::size_t observations, std::size_t map_markers, std::size_t map_triangles);

/// Where the camera is, from ring centres without identity and a map; no prior.
///
/// [P, III-B]: Delaunay triangles of the bearings, AP3P on the map's triangle index, RANSAC, polish on all inliers.
/// @param[out] location  filled if kOk, and as far as known if kAmbiguous; cleared otherwise.
/// @return kTooFew (fewer than min_inliers observations), kNotFound (no pose explains enough of them), kAmbiguous
///         (another pose explains them as well), kDegenerate (inliers do not determine a pose), kOutOfMemory.
/// Deterministic for a seed; bounded by max_hypotheses; no allocation outside the arenas.
Status locate_camera(const camera::Camera& camera, std::span<const Observation> observations, const map::RoomMap& map,
                     const LocateOptions& options, Arena& step, Arena& scratch, CameraLocation& location);

}  // namespace roomcal::pose
