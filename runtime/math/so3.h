#pragma once

#include "runtime/math/types.h"

namespace roomcal {

/// The cross-product matrix: hat(v) * w = v x w.
Mat33 hat(const Vec3& v);

/// Rotation by |phi_rad| about phi (Rodrigues). Exact to rounding for every angle, zero included.
Mat33 so3_exp(const Vec3& phi_rad);

/// Inverse of so3_exp with |phi| <= pi. Good to 1e-12 up to pi, where the axis' sign is arbitrary.
Vec3 so3_log(const Mat33& R);

/// Left Jacobian: exp(phi + d) = exp(J_l(phi) d) exp(phi) to first order.
/// Source: Sola, Deray, Atchuthan, "A micro Lie theory for state estimation in robotics", eq. (145).
Mat33 so3_left_jacobian(const Vec3& phi_rad);
Mat33 so3_left_jacobian_inverse(const Vec3& phi_rad);

/// Right Jacobian: exp(phi + d) = exp(phi) exp(J_r(phi) d) to first order; J_r(phi) = J_l(-phi).
inline Mat33 so3_right_jacobian(const Vec3& phi_rad) { return so3_left_jacobian(-phi_rad); }
inline Mat33 so3_right_jacobian_inverse(const Vec3& phi_rad) { return so3_left_jacobian_inverse(-phi_rad); }

/// The rotation nearest to M in the Frobenius norm (SVD). For numbers read from files, which are rounded.
Mat33 nearest_rotation(const Mat33& M);

}  // namespace roomcal
