#pragma once

#include "runtime/math/so3.h"
#include "runtime/math/types.h"

namespace roomcal {

/// A rigid transform. `T_a_b` maps coordinates in b to coordinates in a:  p_a = T_a_b * p_b = R p_b + t.
///
/// Tangent order everywhere: (translation rho [m], rotation phi [rad]). Perturbations act on the right:
///     T = T_hat * se3_exp(xi),   xi ~ N(0, Sigma)
/// so xi, and with it every 6x6 covariance of a T_a_b, is expressed in frame b.
struct SE3 {
  Mat33 R = Mat33::Identity();
  Vec3 t = Vec3::Zero();

  SE3 inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
  Mat44 matrix() const;
  /// @param T  4x4, rows; its rotation is replaced by the nearest one (files carry rounded numbers).
  static SE3 from_matrix(const Mat44& T);
};

inline Vec3 operator*(const SE3& T_a_b, const Vec3& p_b) { return T_a_b.R * p_b + T_a_b.t; }
inline SE3 operator*(const SE3& T_a_b, const SE3& T_b_c) { return {T_a_b.R * T_b_c.R, T_a_b.R * T_b_c.t + T_a_b.t}; }

/// exp of (rho, phi): R = so3_exp(phi), t = J_l(phi) rho.
SE3 se3_exp(const Vec6& xi);
/// Inverse of se3_exp, rotation angle in [0, pi].
Vec6 se3_log(const SE3& T);

/// Ad(T) in the order (rho, phi):  T * se3_exp(xi) = se3_exp(Ad(T) xi) * T.
Mat66 se3_adjoint(const SE3& T);

/// Right Jacobian: exp(xi + d) = exp(xi) exp(J_r(xi) d) to first order.
/// Source: Barfoot, "State Estimation for Robotics", eq. (7.85)-(7.86), reordered to (rho, phi).
Mat66 se3_right_jacobian(const Vec6& xi);
Mat66 se3_right_jacobian_inverse(const Vec6& xi);

/// Geodesic angle between two rotations, rad.
double rotation_angle_between(const Mat33& R_a, const Mat33& R_b);

}  // namespace roomcal
