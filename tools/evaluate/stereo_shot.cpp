#include "tools/evaluate/stereo_shot.h"

#include <array>
#include <vector>

#include "runtime/rig/camera_rig.h"

namespace roomcal::tools {
namespace {

std::vector<rig::RingObservation> observations(std::span<const Vec2> centre_px, const pose::CameraLocation& location,
                                               double sigma_px) {
  std::vector<rig::RingObservation> out;
  for (const pose::Correspondence& inlier : location.inliers) {
    out.push_back({centre_px[inlier.observation], sigma_px * sigma_px * Mat22::Identity(), inlier.marker});
  }
  return out;
}

}  // namespace

std::size_t stereo_shot_bytes(std::size_t key_points, std::size_t markers) {
  return rig::solve_scratch_bytes(2, 2 * key_points, markers);
}

bool solve_stereo_shot(const StereoShot& shot, const map::TriangleIndex& index, Arena& step, Arena& scratch,
                       FrameResult& result) {
  const auto left = observations(shot.left_px, shot.left_location, shot.sigma_px);
  const auto right = observations(shot.right_px, shot.right_location, shot.sigma_px);
  std::vector<rig::Landmark> landmarks;
  for (const map::IndexedMarker& marker : index.markers()) landmarks.push_back({marker.p_room, marker.cov_m2});
  const std::array<rig::CameraView, 2> views = {rig::CameraView{&shot.left, left, shot.left_location.T_room_cam},
                                                rig::CameraView{&shot.right, right, shot.right_location.T_room_cam}};
  rig::RigSolution solution;
  if (!rig::solve_cameras(views, landmarks, {}, step, scratch, solution).ok()) return false;
  result.baseline_mm = 1e3 * rig::relative_pose(solution, 0, 1).T_a_b.t.norm();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::size_t count = views[i].observations.size();
    // rms_px is per axis; the paper's figure is the length of the residual.
    result.sum2_px2 += 2.0 * solution.rms_px[i] * solution.rms_px[i] * static_cast<double>(count);
    result.residuals += count;
  }
  return true;
}

}  // namespace roomcal::tools
