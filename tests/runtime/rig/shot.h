#pragma once

#include <cstddef>
#include <vector>

#include "runtime/rig/camera_rig.h"
#include "tests/truth/synthetic_room.h"

namespace roomcal::rig::test {

/// How a shot is simulated.
struct ShotOptions {
  std::size_t cameras = 4;
  truth::LensKind lens = truth::LensKind::kWide;
  std::size_t max_observations = 1000;  ///< of each camera
  double min_sigma_px = 0.05;           ///< of the ring centres; covariances differ in size and direction
  double max_sigma_px = 0.15;
  bool draw_noise = true;
  Mat33 map_cov_m2 = Mat33::Zero();  ///< of every marker; the map that the solver is given is drawn with it
  double start_sigma_m = 0.01;       ///< error of the start poses
  double start_sigma_rad = 0.01;
  double outlier_fraction = 0;  ///< observations moved by 5 to 50 px
  /// Of every camera: what the solver is given is drawn around the true lens with it, and is told it as prior.
  camera::IntrinsicsSigma intrinsics_sigma;
};

/// One simulated shot: what the solver is given, and the truth.
struct Shot {
  std::vector<truth::DeviceCamera> device;
  std::vector<SE3> T_room_cam;  ///< truth
  std::vector<Landmark> landmarks;
  std::vector<std::vector<RingObservation>> observations;
  std::vector<SE3> start_T_room_cam;
  std::vector<camera::Camera> given;  ///< lenses, as the solver is given them
  std::vector<camera::Parameters> intrinsics_sigma;
  std::size_t outliers = 0;

  /// Spans into this shot.
  std::vector<CameraView> views() const;
  std::size_t observation_count() const;
};

/// Device, standpoint, start error, noise and outliers are drawn from `random`; the room is given.
Shot make_shot(truth::Random& random, const std::vector<truth::RoomMarker>& room, const ShotOptions& options);

/// Draws the observations' noise (and the map's) once more around the same truth.
void redraw(truth::Random& random, const std::vector<truth::RoomMarker>& room, const ShotOptions& options, Shot& shot);

/// solve_cameras() with memory of its own.
class Solver {
 public:
  Solver() : step_bytes_(1U << 20U), scratch_bytes_(4U << 20U) {}
  Status solve(const Shot& shot, const SolveOptions& options = {});
  Status solve(std::span<const CameraView> views, std::span<const Landmark> landmarks,
               const SolveOptions& options = {});

  RigSolution solution;
  std::size_t degenerate_view = 99;

 private:
  std::vector<std::byte> step_bytes_, scratch_bytes_;
};

/// xi with estimate = truth * exp(xi)^-1, that is truth = estimate * exp(xi): what the covariance describes.
inline Vec6 pose_error(const SE3& estimate, const SE3& truth) { return se3_log(estimate.inverse() * truth); }

}  // namespace roomcal::rig::test
