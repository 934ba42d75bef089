#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/camera/camera.h"
#include "runtime/math/se3.h"

namespace roomcal::rig {

/// A map point that at least one camera sees, with its prior.
struct Landmark {
  Vec3 p_room = Vec3::Zero();    ///< prior mean, m
  Mat33 cov_m2 = Mat33::Zero();  ///< prior covariance; zero: exact, held fixed
};

/// One ring centre of one camera, assigned to a landmark.
struct RingObservation {
  Vec2 centre_px = Vec2::Zero();
  Mat22 cov_px2 = Mat22::Identity();
  uint16_t landmark = 0;
};

/// One camera of the shot: its model, what it saw, and where the locator put it.
struct CameraView {
  const camera::Camera* camera = nullptr;
  std::span<const RingObservation> observations;
  SE3 T_room_cam;  ///< start value
};

struct SolveOptions {
  int max_iterations = 30;
  double robust_scale = 3.0;    ///< Huber/Cauchy turn-over in sigmas
  double sigma_floor_px = 0.0;  ///< added in quadrature to every observation: model error that the detector cannot see
};

enum class StopReason : uint8_t { kConverged, kMaxIterations, kDegenerate };

/// The joint solution. All spans live in the step arena; index = number of the view.
struct RigSolution {
  std::span<SE3> T_room_cam;
  /// Joint covariance of all camera poses, 6n x 6n row-major, right perturbations (m, rad).
  std::span<double> cov_room;
  std::span<double> rms_px;  ///< per camera, all observations, after the fit
  double chi2 = 0;           ///< weighted, reprojection and map prior
  int degrees_of_freedom = 0;
  int iterations = 0;
  StopReason stop = StopReason::kMaxIterations;

  Mat66 cov_block(std::size_t i, std::size_t j) const;
};

/// T_a_b of two cameras of one solution and its covariance (right perturbation, frame b).
struct RelativePose {
  SE3 T_a_b;
  Mat66 cov;
};
RelativePose relative_pose(const RigSolution& solution, std::size_t a, std::size_t b);

/// Scratch and step bytes that solve_cameras() needs.
std::size_t solve_scratch_bytes(std::size_t views, std::size_t observations, std::size_t landmarks);

/// All cameras of a shot in one robust Levenberg-Marquardt on reprojection [P, III-B], the map's covariance as prior.
///
/// Minimizes  sum rho(|centre - project(T_cam_room p)|^2_cov) + sum |p - p_prior|^2_cov  over poses and map points; the
/// points are eliminated by the Schur complement (block-diagonal), so the cost is linear in observations.
/// @return kOk; kDegenerate (a camera's pose is not determined by its observations; detail says what to do);
///         kNotConverged; kOutOfMemory. The solution is filled only for kOk.
Status solve_cameras(std::span<const CameraView> views, std::span<const Landmark> landmarks,
                     const SolveOptions& options, Arena& step, Arena& scratch, RigSolution& solution);

}  // namespace roomcal::rig
