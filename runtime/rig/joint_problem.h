#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/math/robust_loss.h"
#include "runtime/rig/camera_rig.h"
#include "runtime/rig/plane_terms.h"

namespace roomcal::rig {

using Mat28 = Eigen::Matrix<double, 2, camera::kIntrinsicsCount>;

/// One observation, linearized. Everything is whitened: residuals have unit covariance.
struct Term {
  uint16_t view = 0;
  uint16_t landmark = 0;
  Vec2 centre_px = Vec2::Zero();
  Mat22 W = Mat22::Identity();  ///< cov^-1 = W^T W, the floor included
  Vec2 r = Vec2::Zero();
  Mat26 J_pose = Mat26::Zero();
  Mat23 J_u = Mat23::Zero();  ///< in the landmark's own unit, see LandmarkTerms
  bool visible = false;       ///< the point can be projected at the present state
  double weight = 0;          ///< of the robust loss; 0 where not visible
};

/// A landmark is p_room = prior + L u with L L^T = cov and u ~ N(0, I): a covariance of any rank needs no inverse, and
/// an exact point is L = 0.
struct LandmarkTerms {
  Vec3 prior_room = Vec3::Zero();
  Mat33 L = Mat33::Zero();
  bool exact = true;
  uint32_t first = 0;  ///< its observations: by_landmark[first .. first + count)
  uint32_t count = 0;
  Mat33 C_inv = Mat33::Identity();  ///< inverse of its 3x3 block of the (damped) information
  Vec3 g = Vec3::Zero();            ///< gradient in u
};

inline constexpr std::size_t kHeldLens = SIZE_MAX;

struct ViewTerms {
  const camera::Camera* camera = nullptr;  ///< as it came in
  std::size_t lens = kHeldLens;            ///< number among the refined ones
  uint32_t first = 0;                      ///< its observations: terms[first .. first + count)
  uint32_t count = 0;
  double turn_over = 0;  ///< of the robust loss, sigmas
};

/// A camera's intrinsics that are refined along: prior + sigma v with v ~ N(0, I), parameter by parameter. One with
/// sigma 0 is held.
struct LensTerms {
  std::size_t view = 0;
  camera::Parameters sigma = camera::Parameters::Zero();
};

/// What the iteration changes.
struct State {
  std::span<SE3> T_room_sensor;  ///< cameras, then LiDARs
  std::span<Vec3> u;
  std::span<camera::Parameters> v{};   ///< of the refined lenses
  std::span<camera::Camera> camera{};  ///< with these v
};

/// All sensors and map points of a shot as one least-squares problem; lives in a scratch arena.
struct JointProblem {
  std::span<Term> terms;            ///< view by view
  std::span<uint32_t> by_landmark;  ///< numbers of terms, landmark by landmark
  std::span<ViewTerms> views;
  std::span<LensTerms> lenses;        ///< view by view; empty if all intrinsics are held
  std::span<Mat28> J_lens;            ///< of every term, in its lens' v, whitened; empty without lenses
  std::span<const LidarView> lidars;  ///< the caller's, and so are the next two
  std::span<const Landmark> given;
  std::span<const Mat33> plane_cov;
  LidarsOnPlanes planes;
  std::size_t reference = kNoReference;
  std::span<LandmarkTerms> landmarks;
  std::span<double> sorted;  ///< scratch of update_turn_over(), one per term
  State state, trial;
  double robust_scale = 3;

  /// Lays the problem out. The inputs have passed check_inputs(). @return kOk or kOutOfMemory.
  static Status build(const RigInput& input, const SolveOptions& options, Arena& scratch, JointProblem& problem);
  /// Bytes that build() takes.
  static std::size_t bytes(std::size_t sensors, std::size_t observations, std::size_t landmarks, std::size_t lenses);

  const camera::Camera& camera(const State& at, std::size_t view) const {
    const std::size_t lens = views[view].lens;
    return lens == kHeldLens ? *views[view].camera : at.camera[lens];
  }

  Vec3 point_room(const State& at, std::size_t landmark) const {
    const LandmarkTerms& l = landmarks[landmark];
    return l.exact ? l.prior_room : Vec3(l.prior_room + l.L * at.u[landmark]);
  }

  /// The robust cost, priors included.
  double cost(const State& at) const;
  /// Its part from the prior of refined intrinsics.
  double lens_cost(const State& at) const;

  /// Residuals and Jacobians of all terms at `state`; reweight() comes next.
  void linearize();

  /// Weights of all terms for the present turn-over. @return the cost.
  double reweight();

  /// Sets each view's turn-over to robust_scale x the typical size of its residuals (median; 1 if the covariances are
  /// true), never raising it and never below robust_scale. A start far from the answer so begins with a wide one.
  void update_turn_over();
};

}  // namespace roomcal::rig
