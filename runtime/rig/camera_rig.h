#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/camera/camera.h"
#include "runtime/camera/parameters.h"
#include "runtime/math/pose_information.h"
#include "runtime/math/se3.h"

namespace roomcal::rig {

/// Most views and sweeps in one problem, which a host may make of several shots; the reduced system is dense, 6 x 6
/// blocks for every pair.
inline constexpr std::size_t kMaxViews = 64;
inline constexpr std::size_t kMaxLidars = 32;

inline constexpr uint16_t kNoPlane = 0xFFFF;

/// A map point, with its prior. Points that no camera observes are allowed and ignored.
struct Landmark {
  Vec3 p_room = Vec3::Zero();    ///< prior mean, m
  Mat33 cov_m2 = Mat33::Zero();  ///< prior covariance, positive semi-definite; zero: exact, held fixed
  uint16_t plane = kNoPlane;     ///< of the map, if the point is one of those that the plane was fitted to
  /// What the point's error, m, adds to the error of its plane, (m, rad, rad).
  Mat33 plane_by_point = Mat33::Zero();
};

/// What an error of a plane of the map, (offset, tilt, tilt) of map/plane_error.h, adds to the gradient of a LiDAR's
/// points: pull * error.
struct PlanePull {
  uint16_t plane = 0;
  Eigen::Matrix<double, 6, 3> pull = Eigen::Matrix<double, 6, 3>::Zero();
};
/// Most planes that one LiDAR may be pulled by.
inline constexpr std::size_t kMaxPulls = 64;

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
  /// How far its parameters may be off, 1-sigma, independent of each other. They are refined along with the poses, with
  /// this as prior; one of 0 is held, and so are all by default.
  camera::Parameters intrinsics_sigma = camera::Parameters::Zero();
};

/// Where the drawing puts a LiDAR on the reference camera, and how far off it may be, per axis. Takes part as a
/// measurement: it carries the directions that the LiDAR's points leave open, and no others noticeably.
struct LidarMount {
  bool known = false;
  SE3 T_reference_lidar;
  double sigma_t_m = 0;
  double sigma_rot_rad = 0;
};

/// One LiDAR of the shot: what its points say about its pose, as a quadratic around where they were linearized.
struct LidarView {
  PoseInformation points;
  LidarMount mount;
  double open_sigma_t_m = 1.0;  ///< 1-sigma of a direction that nothing fixes
  double open_sigma_rot_rad = 0.5;
  std::span<const PlanePull> pulls = {};  ///< of the planes that its points lie on
};

inline constexpr std::size_t kNoReference = SIZE_MAX;

/// Everything that one shot brings. Sensors are numbered cameras first, then LiDARs.
struct RigInput {
  std::span<const CameraView> cameras;
  std::span<const LidarView> lidars;
  std::size_t reference = kNoReference;  ///< the camera that mounts are relative to; without it they take no part
  std::span<const Landmark> landmarks;   ///< at most 65536, numbered by the observations
  /// Covariance of the errors of the map's planes, by their number; zero: exact. Empty: all are.
  std::span<const Mat33> plane_cov = {};
};

struct SolveOptions {
  int max_iterations = 50;
  /// Residual, in sigmas, from which an observation loses weight (robust_loss.h). A camera whose typical residual is
  /// larger than its covariances say gets a wider one in proportion: a wrong sigma then shows in chi2 instead of
  /// turning every observation into an outlier. Raise it only if the covariances have heavy tails.
  double robust_scale = 3.0;
  double sigma_floor_px = 0.0;  ///< added in quadrature to every observation: model error that the detector cannot see
};

enum class StopReason : uint8_t {
  kConverged,      ///< the last step was below 1e-5 sigma
  kMaxIterations,  ///< the last step was below 0.01 sigma when the rounds were used up: good to use all the same
};

/// A camera's intrinsics as they were refined along.
struct RefinedLens {
  std::size_t view = 0;
  camera::Camera camera;
  camera::Parameters prior = camera::Parameters::Zero();
  camera::Parameters prior_sigma = camera::Parameters::Zero();
  camera::Parameters sigma = camera::Parameters::Zero();  ///< after the fit, poses and map free

  /// Whether the shot told a parameter, or the prior did: it brought at least as much information as the prior had.
  bool told_by_shot(Eigen::Index parameter) const {
    return 2 * sigma[parameter] * sigma[parameter] <= prior_sigma[parameter] * prior_sigma[parameter] &&
           prior_sigma[parameter] > 0;
  }
};

/// The joint solution. All spans live in the step arena; index = number of the sensor: cameras, then LiDARs.
struct RigSolution {
  std::span<SE3> T_room_sensor;
  /// Joint covariance of all poses and, after them, of every refined camera's parameters (8 each): square, row-major,
  /// right perturbations (m, rad), parameters in their units. Predicted from the inputs' covariances and the robust
  /// weights, not scaled by the residuals: chi2 says whether to believe it.
  std::span<double> cov_room;
  std::span<RefinedLens> lenses;  ///< view by view; empty if all intrinsics were held
  std::span<double> rms_px;       ///< per camera, all observations, after the fit
  std::span<uint16_t> outliers;   ///< per camera, observations that the robust loss has put aside
  std::span<double> chi2_camera;  ///< per camera, whitened squares of its inliers' residuals
  double chi2 = 0;                ///< whitened squares of the inliers' residuals and of the priors, after the fit
  int degrees_of_freedom = 0;     ///< 2 x inliers - 6 x cameras: the expectation of chi2 if all covariances are true
  int iterations = 0;
  StopReason stop = StopReason::kMaxIterations;

  /// Covariance between the poses of sensors i and j: E[xi_i xi_j^T].
  Mat66 cov_block(std::size_t i, std::size_t j) const;
  /// Covariance of the parameters of a refined lens, and between a sensor's pose and them; `lens` numbers `lenses`.
  camera::ParameterMatrix cov_lens(std::size_t lens) const;
  Eigen::Matrix<double, 6, camera::kIntrinsicsCount> cov_pose_lens(std::size_t sensor, std::size_t lens) const;
  /// The refined lens of a camera; null if it was held.
  const RefinedLens* lens_of(std::size_t view) const;
};

/// T_a_b of two sensors of one solution and its covariance (right perturbation, frame b).
struct RelativePose {
  SE3 T_a_b;
  Mat66 cov;
};

/// T_a_b = T_room_a^-1 T_room_b with the covariance through both blocks and the one between them; a and b number
/// sensors.
RelativePose relative_pose(const RigSolution& solution, std::size_t a, std::size_t b);

/// Scratch that solve_rig() needs, bytes; sensors: cameras and LiDARs; observations of all cameras together; lenses:
/// cameras whose intrinsics are refined; lidars: sensors that planes may pull.
std::size_t solve_scratch_bytes(std::size_t sensors, std::size_t observations, std::size_t landmarks,
                                std::size_t lenses = 0, std::size_t lidars = 0);
/// Step memory that the solution occupies, bytes.
std::size_t solve_step_bytes(std::size_t sensors, std::size_t lenses = 0);

/// All sensors of a shot in one robust Levenberg-Marquardt: cameras on reprojection [P, III-B] with the map's
/// covariance as prior, LiDARs by the information that their points carry, mounts as priors between them.
///
/// Minimizes over poses, map points, and the parameters k of cameras that have a prior for them,
///     sum rho(|project_k(T_cam_room p) - centre|^2_cov) + sum |p - p_prior|^2_cov + sum |(k - k_prior) / sigma|^2
///     + sum (xi' information xi - 2 gradient . xi) + sum |log(T_lidar_reference T_room_reference^-1 T_room_lidar)|^2.
/// LiDARs before the same uncertain planes share their errors (plane_terms.h), which are correlated with the markers'.
/// The points are eliminated by the Schur complement (3x3 blocks), so the cost is linear in observations.
/// @param[out] solution  filled only for kOk.
/// @param[out] degenerate_view  number of the camera to blame, set only for kDegenerate; may be null.
/// @return kOk; kInvalidArgument (not finite, a covariance not positive, a landmark that is not there); kCapacity (more
///         than kMaxViews or kMaxLidars); kDegenerate (a camera's pose is not determined by its observations, or worse
///         than 0.25 m or 0.25 rad; detail says what to do); kNotConverged; kOutOfMemory.
/// Cost: 5 to 9 rounds of 0.2 us an observation; 0.5 ms for four cameras with 300 observations (rig_benchmark.cpp).
Status solve_rig(const RigInput& input, const SolveOptions& options, Arena& step, Arena& scratch, RigSolution& solution,
                 std::size_t* degenerate_view = nullptr);

/// The same for cameras alone.
Status solve_cameras(std::span<const CameraView> views, std::span<const Landmark> landmarks,
                     const SolveOptions& options, Arena& step, Arena& scratch, RigSolution& solution,
                     std::size_t* degenerate_view = nullptr);

}  // namespace roomcal::rig
