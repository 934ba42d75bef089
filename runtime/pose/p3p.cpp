#include "runtime/pose/p3p.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "runtime/pose/quartic.h"

namespace roomcal::pose {
namespace {

/// Sine of the smallest angle that still spans a triangle: below it, a pose moves by more than rounding times 1e6.
constexpr double kMinSine = 1e-9;

}  // namespace

P3pBearings::P3pBearings(std::span<const Vec3, 3> bearing_cam)
    : b1_(bearing_cam[0]), b2_(bearing_cam[1]), b3_(bearing_cam[2]) {
  const Vec3& b1 = b1_;
  const Vec3& b2 = b2_;
  const Vec3 cross = b1.cross(b2);
  sin12_ = cross.norm();
  if (!(sin12_ > kMinSine)) return;
  const Vec3 k3 = cross / sin12_;
  cos12_ = b1.dot(b2);
  k3_b3_ = k3.dot(b3_);
  k3_v1_ = k3.dot(b1.cross(b3_));
  k3_v2_ = k3.dot(b2.cross(b3_));
  basis_.row(0) = b1.transpose();
  basis_.row(1) = k3.transpose();
  basis_.row(2) = b1.cross(k3).transpose();
  valid_ = std::abs(k3_b3_) > kMinSine;
}

Status solve_p3p(const P3pBearings& bearings, std::span<const Vec3, 3> point_room, P3pPoses& T_room_cam) {
  T_room_cam.clear();
  if (!bearings.valid_) return {StatusCode::kDegenerate, "three bearings in one plane: pick another triangle"};
  const Vec3 p12 = point_room[0] - point_room[1];
  const double length12 = p12.norm();
  if (!(length12 > 0)) return {StatusCode::kDegenerate, "two map points of the triple coincide"};
  const Vec3 k1 = p12 / length12;
  const Vec3 u1 = point_room[0] - point_room[2];
  const Vec3 u1_x_k1 = u1.cross(k1);
  const double delta = u1_x_k1.norm();
  if (!(delta > kMinSine * length12)) return {StatusCode::kDegenerate, "three map points of the triple are collinear"};
  const Vec3 k3_pp = u1_x_k1 / delta;
  const double u1_k1 = u1.dot(k1);
  const double u2_k1 = u1_k1 - length12;

  // Coefficients of the two trigonometric equations in theta_1', theta_3' [eq. 17-25].
  const double f11 = delta * bearings.k3_b3_;
  const double f13 = delta * bearings.k3_v1_;
  const double f15 = -u1_k1 * bearings.k3_b3_;
  const double f21 = f11 * bearings.cos12_;
  const double f22 = f11 * bearings.sin12_;
  const double f23 = delta * bearings.k3_v2_;
  const double f24 = u2_k1 * bearings.k3_b3_ * bearings.sin12_;
  const double f25 = -u2_k1 * bearings.k3_b3_ * bearings.cos12_;
  const double g1 = f13 * f22;
  const double g2 = f13 * f25 - f15 * f23;
  const double g3 = f11 * f23 - f13 * f21;
  const double g4 = -f13 * f24;
  const double g5 = f11 * f22;
  const double g6 = f11 * f25 - f15 * f21;
  const double g7 = -f15 * f24;
  FixedVector<double, 4> cos_theta1;
  solve_quartic({g5 * g5 + g1 * g1 + g3 * g3, 2.0 * (g5 * g6 + g1 * g2 + g3 * g4),
                 g6 * g6 + 2.0 * g5 * g7 + g2 * g2 + g4 * g4 - g1 * g1 - g3 * g3, 2.0 * (g6 * g7 - g1 * g2 - g3 * g4),
                 g7 * g7 - g2 * g2 - g4 * g4},
                cos_theta1);

  Mat33 basis_room;
  basis_room.col(0) = k1;
  basis_room.col(1) = k3_pp;
  basis_room.col(2) = k1.cross(k3_pp);
  for (const double root : cos_theta1) {
    if (std::abs(root) > 1.0 + 1e-9) continue;
    const double c1 = std::clamp(root, -1.0, 1.0);
    const double s1 = std::copysign(std::sqrt(1.0 - c1 * c1), bearings.k3_b3_);
    const double scale = s1 / ((g5 * c1 + g6) * c1 + g7);
    double c3 = (g1 * c1 + g2) * scale;
    double s3 = (g3 * c1 + g4) * scale;
    const double norm3 = std::hypot(c3, s3);
    // A true root makes (c3, s3) a unit vector; one that rounding has moved is put back, one that is none is left out.
    if (!(std::abs(norm3 - 1.0) < 1e-2)) continue;
    c3 /= norm3;
    s3 /= norm3;
    Mat33 middle;
    middle << c3, 0, -s3, s1 * s3, c1, s1 * c3, c1 * s3, -s1, c1 * c3;
    SE3 T;
    T.R = basis_room * middle * bearings.basis_;
    T.t = point_room[2] - (delta * s1 / bearings.k3_b3_) * (T.R * bearings.b3_);
    // The sign of theta_1' [Algorithm 1, line 15] makes depth 3 positive; the other two are checked.
    if ((T.R * bearings.b1_).dot(point_room[0] - T.t) <= 0 || (T.R * bearings.b2_).dot(point_room[1] - T.t) <= 0)
      continue;
    static_cast<void>(T_room_cam.push_back(T));
  }
  return ok_status();
}

Status solve_p3p(std::span<const Vec3, 3> bearing_cam, std::span<const Vec3, 3> point_room, P3pPoses& T_room_cam) {
  return solve_p3p(P3pBearings(bearing_cam), point_room, T_room_cam);
}

}  // namespace roomcal::pose
