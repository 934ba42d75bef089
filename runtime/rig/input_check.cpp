#include "runtime/rig/input_check.h"

#include <cmath>

#include <Eigen/LU>

namespace roomcal::rig {

namespace {

// Rounding of numbers that passed through a file or a product of three matrices.
constexpr double kSlack = 1e-9;

bool is_rigid(const SE3& T) {
  if (!T.R.allFinite() || !T.t.allFinite()) return false;
  return (T.R.transpose() * T.R - Mat33::Identity()).norm() < 1e-6 && T.R.determinant() > 0;
}

Status check_view(const CameraView& view, std::size_t landmark_count) {
  if (view.camera == nullptr) return {StatusCode::kInvalidArgument, "a view has no camera model"};
  if (!is_rigid(view.T_room_cam))
    return {StatusCode::kInvalidArgument, "a view's start pose is not a finite rigid transform"};
  if (!view.intrinsics_sigma.allFinite() || view.intrinsics_sigma.minCoeff() < 0)
    return {StatusCode::kInvalidArgument, "the sigmas of a camera's intrinsics must be finite and not negative"};
  for (const RingObservation& observation : view.observations) {
    Mat22 W;
    if (!observation.centre_px.allFinite()) return {StatusCode::kInvalidArgument, "a ring centre is not finite"};
    if (!whitening(observation.cov_px2, W))
      return {StatusCode::kInvalidArgument, "a ring centre's covariance is not positive definite"};
    if (observation.landmark >= landmark_count)
      return {StatusCode::kInvalidArgument, "an observation names a landmark that is not there"};
  }
  return ok_status();
}

Status check_lidar(const LidarView& lidar) {
  const PoseInformation& points = lidar.points;
  if (!is_rigid(points.T_hat))
    return {StatusCode::kInvalidArgument, "a LiDAR was linearized at what is no finite rigid transform"};
  if (!points.information.allFinite() || !points.gradient.allFinite() || points.information.diagonal().minCoeff() < 0)
    return {StatusCode::kInvalidArgument, "a LiDAR's information is not finite and positive semi-definite"};
  if (!(lidar.open_sigma_t_m > 0 && lidar.open_sigma_rot_rad > 0))
    return {StatusCode::kInvalidArgument, "a LiDAR's open sigmas must be positive"};
  if (lidar.pulls.size() > kMaxPulls) return {StatusCode::kCapacity, "a LiDAR is pulled by more planes than kMaxPulls"};
  for (const PlanePull& pull : lidar.pulls)
    if (!pull.pull.allFinite()) return {StatusCode::kInvalidArgument, "a plane's pull on a LiDAR is not finite"};
  if (!lidar.mount.known) return ok_status();
  if (!is_rigid(lidar.mount.T_reference_lidar) || !(lidar.mount.sigma_t_m > 0 && lidar.mount.sigma_rot_rad > 0))
    return {StatusCode::kInvalidArgument, "a LiDAR's mount must be rigid, with positive sigmas"};
  return ok_status();
}

}  // namespace

Status check_inputs(const RigInput& input, const SolveOptions& options) {
  if (input.cameras.empty() && input.lidars.empty()) return {StatusCode::kInvalidArgument, "no sensor to solve for"};
  if (input.cameras.size() > kMaxViews) return {StatusCode::kCapacity, "more cameras than kMaxViews in one problem"};
  if (input.lidars.size() > kMaxLidars) return {StatusCode::kCapacity, "more LiDARs than kMaxLidars in one problem"};
  if (input.reference != kNoReference && input.reference >= input.cameras.size())
    return {StatusCode::kInvalidArgument, "the reference is not one of the cameras"};
  if (!(options.robust_scale > 0 && options.sigma_floor_px >= 0 && std::isfinite(options.robust_scale) &&
        std::isfinite(options.sigma_floor_px) && options.max_iterations > 0))
    return {StatusCode::kInvalidArgument,
            "solve options: scale and iterations must be positive, the floor not negative"};
  for (const Landmark& landmark : input.landmarks) {
    Mat33 L;
    if (!landmark.p_room.allFinite()) return {StatusCode::kInvalidArgument, "a landmark's position is not finite"};
    if (!covariance_root(landmark.cov_m2, L))
      return {StatusCode::kInvalidArgument, "a landmark's covariance is not positive semi-definite"};
    if (!landmark.plane_by_point.allFinite())
      return {StatusCode::kInvalidArgument, "a landmark's share in its plane is not finite"};
  }
  for (const Mat33& cov : input.plane_cov) {
    Mat33 L;
    if (!covariance_root(cov, L))
      return {StatusCode::kInvalidArgument, "a plane's covariance is not positive semi-definite"};
  }
  for (const CameraView& view : input.cameras) ROOMCAL_TRY(check_view(view, input.landmarks.size()));
  for (const LidarView& lidar : input.lidars) ROOMCAL_TRY(check_lidar(lidar));
  return ok_status();
}

bool covariance_root(const Mat33& cov, Mat33& L) {
  if (!cov.allFinite()) return false;
  const double slack = kSlack * cov.trace();
  if ((cov - cov.transpose()).norm() > slack) return false;
  Mat33 root = Mat33::Zero();
  for (int j = 0; j < 3; ++j) {
    const double pivot = cov(j, j) - root.row(j).squaredNorm();
    if (pivot < -slack) return false;
    for (int i = j + 1; i < 3; ++i) {
      const double element = cov(i, j) - root.row(i).dot(root.row(j));
      // Without extent along j there can be no correlation with it either: |c_ij|^2 <= c_ii c_jj.
      if (pivot <= slack && std::abs(element) > std::sqrt(kSlack) * cov.trace()) return false;
      if (pivot > slack) root(i, j) = element / std::sqrt(pivot);
    }
    if (pivot > slack) root(j, j) = std::sqrt(pivot);
  }
  L = root;
  return true;
}

bool whitening(const Mat22& cov, Mat22& W) {
  const double xx = cov(0, 0), xy = 0.5 * (cov(0, 1) + cov(1, 0)), yy = cov(1, 1);
  if (!(xx > 0 && yy > 0 && xx < 1e12 && yy < 1e12)) return false;
  if (!(std::abs(cov(0, 1) - cov(1, 0)) <= kSlack * (xx + yy))) return false;
  const double rest = yy - xy * xy / xx;
  if (!(rest > kSlack * yy)) return false;
  const double a = 1 / std::sqrt(xx), b = 1 / std::sqrt(rest);
  W << a, 0, -b * xy / xx, b;
  return true;
}

}  // namespace roomcal::rig
