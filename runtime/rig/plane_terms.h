#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/rig/camera_rig.h"

namespace roomcal::rig {

using Mat63 = Eigen::Matrix<double, 6, 3>;

/// What an error of one plane does to one LiDAR's own estimate: moves it by gain * delta.
struct PlaneGain {
  std::size_t lidar = 0;
  std::size_t plane = 0;
  Mat63 gain = Mat63::Zero();
};

/// What the points of all LiDARs say together, where planes that they were measured against may be off.
///
/// Alone, LiDAR l with points' information A and gradient g estimates xi = A^-1 g, in error by A^-1 of noise and, as
/// plane p is off by delta_p ~ N(0, Q_p), by W_lp delta_p with W_lp = A^-1 pull_lp. So all estimates together have the
/// covariance
///     diag(A_l^-1) + sum_p W_p Q_p W_p^T,
/// in which LiDARs that stand before the same walls share their errors, and its inverse is their information. That is
/// what eliminating the planes as unknowns gives, but for what ranges tell about the planes themselves: little, as the
/// beams' offsets are unknown.
struct LidarsOnPlanes {
  std::span<double> information;  ///< 6L x 6L row-major, symmetric
  std::span<double> estimate;     ///< 6L: xi of each LiDAR from where its points were linearized
  std::span<PlaneGain> gains;     ///< LiDAR by LiDAR

  /// Whether any plane that a LiDAR sees may be off; otherwise each LiDAR's points stand for themselves.
  bool used() const { return !gains.empty(); }

  /// @return kOk; kOutOfMemory; kDegenerate if the covariance is not positive definite.
  static Status build(const RigInput& input, Arena& scratch, LidarsOnPlanes& planes);
  /// Bytes that build() takes at most.
  static std::size_t bytes(std::size_t lidars);

  Mat66 information_block(std::size_t a, std::size_t b) const;
  Vec6 estimate_of(std::size_t lidar) const;
};

/// Information of a LiDAR's points, open directions at their own width.
Mat66 own_information(const LidarView& lidar);

struct JointProblem;
struct NormalEquations;

/// A plane's error is not independent of the markers on it: the plane was fitted to them. Cameras that see a wall's
/// markers and LiDARs that see the wall are therefore off together, and their extrinsics less than if they were not.
/// Adds that to the covariance of a solved problem: with u_i ~ N(0, I) the error of marker i, delta = sum N_i u_i, and
/// the solution's errors S^-1 B_i C_i^-1 u_i and S^-1 Z_p delta_p,
///     cov += P + P^T,  P = S^-1 (sum_p (sum_i B_i C_i^-1 N_i^T) Z_p^T) S^-1.
/// Nothing if no plane that a LiDAR sees may be off.
/// @param equations  assembled at the solution without damping, then inverted; S is used as scratch.
/// @param[in,out] cov  S^-1, of the size of the equations, n.
/// @return kOk or kOutOfMemory. Cost: n^2 multiplications a plane, nine times.
Status correlate_planes_with_markers(const JointProblem& problem, NormalEquations& equations, Arena& scratch,
                                     std::span<double> cov);
/// Scratch that it needs, bytes.
std::size_t correlation_bytes(std::size_t unknowns);

}  // namespace roomcal::rig
