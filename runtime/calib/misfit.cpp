#include "runtime/calib/misfit.h"

#include <algorithm>
#include <cmath>

#include "runtime/base/reason.h"

namespace roomcal::calib {

namespace {

/// Intrinsics of another camera of the same make, or a map from a tape measure, leave about so much.
constexpr double kForgiven_px = 1.0;
constexpr int kMaxHypotheses = 250000;
/// Sizes of rings are good to a few percent each, their mean to one.
constexpr double kSizeMisfit = 0.05;

/// Apparent radius over the one that map and pose predict, mean of the logarithms; 1 without sizes.
double size_ratio(const camera::Camera& camera, std::span<const pose::Observation> observations,
                  std::span<const double> major_px, const map::TriangleIndex& index,
                  const pose::CameraLocation& location) {
  double sum = 0;
  int count = 0;
  for (const pose::Correspondence& inlier : location.inliers) {
    const map::IndexedMarker& marker = index.markers()[inlier.marker];
    Vec3 bearing_cam;
    Mat32 bearing_by_px;
    const pose::Observation& seen = observations[inlier.observation];
    if (!marker.has_radius || !(major_px[inlier.observation] > 0)) continue;
    if (!camera.unproject(seen.centre_px, bearing_cam, &bearing_by_px).ok()) continue;
    const Vec2 major_axis(std::cos(seen.angle_rad), std::sin(seen.angle_rad));
    const double seen_rad = 0.5 * major_px[inlier.observation] * (bearing_by_px * major_axis).norm();
    const double range_m = (marker.p_room - location.T_room_cam.t).norm();
    sum += std::log(seen_rad / std::atan(marker.radius_m / range_m));
    ++count;
  }
  return count > 0 ? std::exp(sum / count) : 1.0;
}

}  // namespace

Reason explain_misfit(const CameraSpec& camera, std::span<pose::Observation> observations,
                      const map::TriangleIndex& index, Arena& step, Arena& scratch) {
  const Arena::Scope step_scope(step), scratch_scope(scratch);
  const auto major_px = scratch.allocate<double>(observations.size());
  if (major_px.empty()) return {};
  for (std::size_t i = 0; i < observations.size(); ++i) {
    major_px[i] = observations[i].major_px;
    observations[i].major_px = 0;  // the size: not known
    observations[i].cov_px2 += kForgiven_px * kForgiven_px * Mat22::Identity();
  }
  pose::LocateOptions options;
  options.max_hypotheses = kMaxHypotheses;
  pose::CameraLocation location;
  if (!pose::locate_camera(camera.camera, observations, index, options, step, scratch, location).ok()) return {};

  const Name who(camera.name);
  const double ratio = size_ratio(camera.camera, observations, major_px, index, location);
  if (std::abs(std::log(ratio)) > kSizeMisfit)
    return make_reason(
        "%.*s: its rings look %.2f times as large as the map's radius makes them: is that the radius of "
        "the printed outer circle?",
        who.length, who.text, ratio);
  return make_reason(
      "%.*s: %zu of %zu markers fit a pose to %.2f px only, not as well as claimed: intrinsics of another "
      "camera? else refine them along, give it sigma_px in device.yaml, or the map its --sigma",
      who.length, who.text, location.inliers.size(), observations.size(), location.rms_px);
}

}  // namespace roomcal::calib
