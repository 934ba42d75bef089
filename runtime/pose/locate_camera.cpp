#include "runtime/pose/locate_camera.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "runtime/pose/image_triangles.h"
#include "runtime/pose/polish.h"
#include "runtime/pose/pose_search.h"

namespace roomcal::pose {
namespace {

/// The largest standard deviation of a 3 x 3 covariance in any direction.
double largest_sigma(const Mat33& cov) {
  Eigen::SelfAdjointEigenSolver<Mat33> eigen;
  eigen.computeDirect(cov, Eigen::EigenvaluesOnly);
  return cov.allFinite() ? std::sqrt(std::max(eigen.eigenvalues()[2], 0.0)) : std::numeric_limits<double>::infinity();
}

Status list_inliers(const SightSet& set, std::span<const uint16_t> marker_of_sight, Arena& step,
                    CameraLocation& location) {
  const auto count = set.sights.size() -
                     static_cast<std::size_t>(std::count(marker_of_sight.begin(), marker_of_sight.end(), kNoMarker));
  location.inliers = step.allocate<Correspondence>(count);
  if (location.inliers.size() != count) return out_of_arena("inliers of a located camera");
  std::size_t i = 0;
  for (std::size_t k = 0; k < set.sights.size(); ++k) {
    if (marker_of_sight[k] != kNoMarker) location.inliers[i++] = {set.sights[k].observation, marker_of_sight[k]};
  }
  std::sort(location.inliers.begin(), location.inliers.end(),
            [](const Correspondence& a, const Correspondence& b) { return a.observation < b.observation; });
  return ok_status();
}

void measure_fit(const camera::Camera& camera, std::span<const Observation> observations,
                 const map::TriangleIndex& index, CameraLocation& location) {
  const camera::Intrinsics& intrinsics = camera.intrinsics();
  std::bitset<16> cells;
  double sum2 = 0;
  int count = 0;
  for (const Correspondence& inlier : location.inliers) {
    const Vec2& centre_px = observations[inlier.observation].centre_px;
    const int column = static_cast<int>(4.0 * (centre_px.x() + 0.5) / intrinsics.width_px);
    const int row = static_cast<int>(4.0 * (centre_px.y() + 0.5) / intrinsics.height_px);
    cells.set(static_cast<std::size_t>(4 * std::clamp(row, 0, 3) + std::clamp(column, 0, 3)));
    Vec2 predicted_px;
    const Vec3 p_cam = location.T_room_cam.inverse() * index.markers()[inlier.marker].p_room;
    if (!camera.project(p_cam, predicted_px).ok()) continue;
    sum2 += (predicted_px - centre_px).squaredNorm();
    ++count;
  }
  location.coverage = static_cast<double>(cells.count()) / 16.0;
  location.rms_px = count > 0 ? std::sqrt(sum2 / (2.0 * count)) : 0.0;
}

void find_second(std::span<const PolishedPose> found, CameraLocation& location) {
  for (const PolishedPose& other : found.subspan(1)) {
    if (!is_clearly_another(found[0], other.T_room_cam)) continue;
    location.has_second = true;
    location.T_room_cam_second = other.T_room_cam;
    location.log_likelihood_gap = found[0].support.log_likelihood - other.support.log_likelihood;
    return;  // they come by falling likelihood
  }
}

bool within(const Mat66& cov, double max_sigma_m, double max_sigma_rad) {  // NaN is not
  return largest_sigma(cov.topLeftCorner<3, 3>()) <= max_sigma_m &&
         largest_sigma(cov.bottomRightCorner<3, 3>()) <= max_sigma_rad;
}

/// @param cov_rings  of the pose if the map were exact
Status judge(const LocateOptions& options, const Mat66& cov_rings, const CameraLocation& location) {
  if (!within(cov_rings, options.max_sigma_m, options.max_sigma_rad)) {
    return {StatusCode::kDegenerate, "the markers in view do not determine the pose: show the camera more of the room"};
  }
  if (!within(location.cov, options.max_map_sigma_m, options.max_map_sigma_rad)) {
    return {StatusCode::kDegenerate,
            "the map is too uncertain to tell the pose: survey the room again, or show the camera more of it"};
  }
  if (location.log_likelihood_gap < options.min_log_likelihood_gap) {
    return {StatusCode::kAmbiguous, "another pose explains the markers as well: show the camera more of the room"};
  }
  return ok_status();
}

std::size_t work_bytes(std::size_t observations) {
  return observations * (sizeof(Vec3) + sizeof(uint16_t) + sizeof(double)) + 3 * alignof(std::max_align_t);
}

}  // namespace

std::size_t locate_scratch_bytes(std::size_t observations) {
  return sights_bytes(observations) + image_triangles_bytes(observations) + work_bytes(observations);
}

std::size_t locate_step_bytes(std::size_t observations) {
  return observations * sizeof(Correspondence) + alignof(std::max_align_t);
}

Status locate_camera(const camera::Camera& camera, std::span<const Observation> observations,
                     const map::TriangleIndex& index, const LocateOptions& options, Arena& step, Arena& scratch,
                     CameraLocation& location) {
  location = {};
  const auto needed = static_cast<std::size_t>(std::max(options.min_inliers, 3));
  if (observations.size() < needed) return {StatusCode::kTooFew, "too few markers seen: light, focus, or room?"};
  Arena::Scope scope(scratch);
  SightSet set;
  ROOMCAL_TRY(make_sights(camera, observations, options.gate_px, scratch, set));
  const std::size_t n = set.sights.size();
  if (n < needed)
    return {StatusCode::kTooFew, "too few markers inside the camera model's valid field: are these its intrinsics?"};

  const std::span<Vec3> bearing_cam = scratch.allocate<Vec3>(n);
  const std::span<uint16_t> marker_of_sight = scratch.allocate<uint16_t>(n);
  const std::span<double> work = scratch.allocate<double>(n);
  if (bearing_cam.empty() || marker_of_sight.empty() || work.empty()) return out_of_arena("camera location");
  for (std::size_t i = 0; i < n; ++i) bearing_cam[i] = set.sights[i].bearing_cam;
  std::span<Triple> triangles;
  ROOMCAL_TRY(image_triangles(bearing_cam, {}, scratch, triangles));
  if (triangles.empty())
    return {StatusCode::kDegenerate, "the markers in view lie on one line: turn the device or add markers"};

  const Matcher matcher(set, index);
  PoseSearch search(matcher, options, n, triangles, marker_of_sight, work);
  search.run();
  search.challenge();
  location.hypotheses = search.hypotheses();
  if (search.found().empty() || !search.accepts(search.found()[0].support)) {
    return {StatusCode::kNotFound,
            "no pose in this map explains the markers: another room, a changed one, or intrinsics of another camera?"};
  }

  const PolishedPose& best = search.found()[0];
  location.T_room_cam = best.T_room_cam;
  location.cov = best.cov;
  location.log_odds = search.log_odds(best.support);
  matcher.match(best.T_room_cam, 1.0, marker_of_sight, work);
  if (Status status = list_inliers(set, marker_of_sight, step, location); !status.ok()) {
    location = {};
    return status;
  }
  measure_fit(camera, observations, index, location);
  find_second(search.found(), location);
  return judge(options, covariance_of_rings(set, index, marker_of_sight, best.T_room_cam), location);
}

}  // namespace roomcal::pose
