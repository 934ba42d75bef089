#include "runtime/math/se3.h"

#include <cmath>

namespace roomcal {

namespace {

// Q of the left Jacobian (Barfoot eq. 7.86b): the coupling of translation to rotation.
Mat33 coupling(const Vec3& rho, const Vec3& phi) {
  const double t2 = phi.squaredNorm();
  const double t = std::sqrt(t2);
  double b, c, d;
  if (t < 0.1) {  // series; relative error < 1e-14 at the switch, where the closed forms still hold 1e-11
    b = 1.0 / 6 - t2 / 120 * (1 - t2 / 42 * (1 - t2 / 72));
    c = 1.0 / 24 - t2 / 720 * (1 - t2 / 56 * (1 - t2 / 90));
    d = 1.0 / 120 - t2 / 2520 * (1 - t2 / 48 * (1 - t2 / 82.5));
  } else {
    const double s = std::sin(t), co = std::cos(t);
    b = (t - s) / (t2 * t);
    c = (t2 + 2 * co - 2) / (2 * t2 * t2);
    d = (2 * t - 3 * s + t * co) / (2 * t2 * t2 * t);
  }
  const Mat33 P = hat(rho), W = hat(phi);
  return 0.5 * P + b * (W * P + P * W + W * P * W) + c * (W * W * P + P * W * W - 3 * W * P * W) +
         d * (W * P * W * W + W * W * P * W);
}

}  // namespace

Mat44 SE3::matrix() const {
  Mat44 T = Mat44::Identity();
  T.topLeftCorner<3, 3>() = R;
  T.topRightCorner<3, 1>() = t;
  return T;
}

SE3 SE3::from_matrix(const Mat44& T) { return {nearest_rotation(T.topLeftCorner<3, 3>()), T.topRightCorner<3, 1>()}; }

SE3 se3_exp(const Vec6& xi) {
  const Vec3 phi = xi.tail<3>();
  return {so3_exp(phi), so3_left_jacobian(phi) * xi.head<3>()};
}

Vec6 se3_log(const SE3& T) {
  const Vec3 phi = so3_log(T.R);
  Vec6 xi;
  xi << so3_left_jacobian_inverse(phi) * T.t, phi;
  return xi;
}

Mat66 se3_adjoint(const SE3& T) {
  Mat66 A = Mat66::Zero();
  A.topLeftCorner<3, 3>() = T.R;
  A.topRightCorner<3, 3>() = hat(T.t) * T.R;
  A.bottomRightCorner<3, 3>() = T.R;
  return A;
}

Mat66 se3_right_jacobian(const Vec6& xi) {
  const Vec3 rho = -xi.head<3>(), phi = -xi.tail<3>();
  const Mat33 J = so3_left_jacobian(phi);
  Mat66 out = Mat66::Zero();
  out.topLeftCorner<3, 3>() = J;
  out.topRightCorner<3, 3>() = coupling(rho, phi);
  out.bottomRightCorner<3, 3>() = J;
  return out;
}

Mat66 se3_right_jacobian_inverse(const Vec6& xi) {
  const Vec3 rho = -xi.head<3>(), phi = -xi.tail<3>();
  const Mat33 J_inv = so3_left_jacobian_inverse(phi);
  Mat66 out = Mat66::Zero();
  out.topLeftCorner<3, 3>() = J_inv;
  out.topRightCorner<3, 3>() = -J_inv * coupling(rho, phi) * J_inv;
  out.bottomRightCorner<3, 3>() = J_inv;
  return out;
}

double rotation_angle_between(const Mat33& R_a, const Mat33& R_b) { return so3_log(R_a.transpose() * R_b).norm(); }

}  // namespace roomcal
