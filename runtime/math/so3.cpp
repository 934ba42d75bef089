#include "runtime/math/so3.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace roomcal {

namespace {

// Below this angle the closed forms lose digits to cancellation; the series then have relative error < 1e-16.
constexpr double kSmallAngleRad = 1e-2;

struct Coefficients {
  double a;  // sin(t) / t
  double b;  // (1 - cos t) / t^2
  double c;  // (t - sin t) / t^3
};

Coefficients coefficients(double t2) {
  const double t = std::sqrt(t2);
  if (t < kSmallAngleRad)
    return {1 - t2 / 6 * (1 - t2 / 20 * (1 - t2 / 42)), 0.5 * (1 - t2 / 12 * (1 - t2 / 30 * (1 - t2 / 56))),
            (1 - t2 / 20 * (1 - t2 / 42 * (1 - t2 / 72))) / 6};
  const double half_sin = std::sin(t / 2);
  return {std::sin(t) / t, 2 * half_sin * half_sin / t2, (t - std::sin(t)) / (t2 * t)};
}

}  // namespace

Mat33 hat(const Vec3& v) {
  Mat33 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Mat33 so3_exp(const Vec3& phi_rad) {
  const Coefficients k = coefficients(phi_rad.squaredNorm());
  const Mat33 W = hat(phi_rad);
  return Mat33::Identity() + k.a * W + k.b * W * W;
}

Vec3 so3_log(const Mat33& R) {
  // Through the quaternion: its largest component is at least 1/2, so no branch loses digits near pi.
  Eigen::Quaterniond q(R);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sin_half = q.vec().norm();
  if (sin_half < 1e-9) return 2.0 / q.w() * q.vec();
  return (2.0 * std::atan2(sin_half, q.w()) / sin_half) * q.vec();
}

Mat33 so3_left_jacobian(const Vec3& phi_rad) {
  const Coefficients k = coefficients(phi_rad.squaredNorm());
  const Mat33 W = hat(phi_rad);
  return Mat33::Identity() + k.b * W + k.c * W * W;
}

Mat33 so3_left_jacobian_inverse(const Vec3& phi_rad) {
  const double t2 = phi_rad.squaredNorm();
  const double t = std::sqrt(t2);
  const double half = t / 2;
  const double d =
      t < kSmallAngleRad ? (1 + t2 / 60 * (1 + t2 / 42)) / 12 : (1 - half * std::cos(half) / std::sin(half)) / t2;
  const Mat33 W = hat(phi_rad);
  return Mat33::Identity() - 0.5 * W + d * W * W;
}

Mat33 nearest_rotation(const Mat33& M) {
  const Eigen::JacobiSVD<Mat33> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat33 D = Mat33::Identity();
  D(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * D * svd.matrixV().transpose();
}

}  // namespace roomcal
