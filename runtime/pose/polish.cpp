#include "runtime/pose/polish.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace roomcal::pose {
namespace {

/// Residuals beyond this many sigmas count linearly; Gaussian ones hardly ever reach it, so the covariance stays true.
constexpr double kHuber_sigmas = 3.0;
/// Gates of the rounds, as a multiple of the final one: a minimal solution errs by several times the noise.
constexpr double kGateScales[] = {3.0, 2.0, 1.0, 1.0};

struct NormalEquations {
  Mat66 H = Mat66::Zero();
  Vec6 b = Vec6::Zero();
  int rows = 0;
};

/// A sight's residual against a point, and its derivative by a right perturbation of the pose.
struct SightError {
  Vec2 residual;
  Mat26 J;
  double range_m;
};

SightError sight_error(const Sight& sight, const Vec3& p_room, const SE3& T_room_cam) {
  const Vec3 p_cam = T_room_cam.R.transpose() * (p_room - T_room_cam.t);
  SightError error;
  error.range_m = p_cam.norm();
  const Vec3 direction_cam = p_cam / error.range_m;
  error.residual = sight.tangent.transpose() * direction_cam;
  // d direction / d p_cam = (I - d d^T) / range;  d p_cam / d (rho, phi) = [-I, hat(p_cam)].
  const Mat23 by_point = (sight.tangent.transpose() - error.residual * direction_cam.transpose()) / error.range_m;
  error.J.leftCols<3>() = -by_point;
  error.J.rightCols<3>() = by_point * hat(p_cam);
  return error;
}

void add_residual(const Sight& sight, const map::IndexedMarker& marker, const SE3& T_room_cam,
                  NormalEquations& normal) {
  const SightError error = sight_error(sight, marker.p_room, T_room_cam);
  const Mat22 information = residual_covariance(sight, marker, T_room_cam.R, error.range_m).inverse();
  const double sigmas = std::sqrt(error.residual.dot(information * error.residual));
  const double weight = sigmas > kHuber_sigmas ? kHuber_sigmas / sigmas : 1.0;
  const Eigen::Matrix<double, 6, 2> weighted = weight * error.J.transpose() * information;
  normal.H += weighted * error.J;
  normal.b -= weighted * error.residual;
  ++normal.rows;
}

}  // namespace

Status refine_pose(const SightSet& set, const map::TriangleIndex& index, std::span<const uint16_t> marker_of_sight,
                   int iterations, SE3& T_room_cam, Mat66& cov) {
  SE3 T = T_room_cam;
  Eigen::LDLT<Mat66> solver;
  for (int round = 0; round < iterations; ++round) {
    NormalEquations normal;
    for (std::size_t k = 0; k < set.sights.size(); ++k) {
      if (marker_of_sight[k] == kNoMarker) continue;
      add_residual(set.sights[k], index.markers()[marker_of_sight[k]], T, normal);
    }
    if (normal.rows < 3) return {StatusCode::kTooFew, "fewer than three markers support the pose"};
    solver.compute(normal.H);
    const auto& d = solver.vectorD();
    if (solver.info() != Eigen::Success || !(d.minCoeff() > 1e-14 * d.maxCoeff())) {
      return {StatusCode::kDegenerate, "the markers in view do not determine the pose"};
    }
    const Vec6 step = solver.solve(normal.b);
    if (!step.allFinite() || step.norm() > 2.0) return {StatusCode::kDegenerate, "the refinement of the pose ran away"};
    T = T * se3_exp(step);
    if (step.norm() < 1e-9) break;
  }
  T.R = nearest_rotation(T.R);
  T_room_cam = T;
  cov = solver.solve(Mat66::Identity());
  cov = 0.5 * (cov + cov.transpose()).eval();
  return ok_status();
}

Mat66 covariance_of_rings(const SightSet& set, const map::TriangleIndex& index,
                          std::span<const uint16_t> marker_of_sight, const SE3& T_room_cam) {
  Mat66 H = Mat66::Zero();
  for (std::size_t k = 0; k < set.sights.size(); ++k) {
    if (marker_of_sight[k] == kNoMarker) continue;
    const Sight& sight = set.sights[k];
    const Mat26 J = sight_error(sight, index.markers()[marker_of_sight[k]].p_room, T_room_cam).J;
    H += J.transpose() * sight.cov_rad2.inverse() * J;
  }
  return H.inverse();
}

Status polish(const Matcher& matcher, const SE3& T_room_cam_start, std::span<uint16_t> marker_of_sight,
              std::span<double> work, PolishedPose& pose) {
  pose.T_room_cam = T_room_cam_start;
  for (const double gate_scale : kGateScales) {
    matcher.match(pose.T_room_cam, gate_scale, marker_of_sight, work);
    ROOMCAL_TRY(refine_pose(matcher.set(), matcher.index(), marker_of_sight, gate_scale > 1.0 ? 3 : 8, pose.T_room_cam,
                            pose.cov));
  }
  pose.support = matcher.match(pose.T_room_cam, 1.0, marker_of_sight, work);
  return ok_status();
}

}  // namespace roomcal::pose
