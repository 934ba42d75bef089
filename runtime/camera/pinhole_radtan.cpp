#include "runtime/camera/pinhole_radtan.h"

#include <algorithm>
#include <cmath>

#include "runtime/camera/field_limit.h"
#include "runtime/camera/radial_newton.h"

namespace roomcal::camera {

namespace {

// Half-way between what a pinhole can mean (below 90 degrees) and what anybody builds.
constexpr double kMaxAngleRad = deg_to_rad(89.0);
constexpr int kMaxRounds = 30;
// A rounding error of the last few bits of m_d; further rounds would only dance about it.
constexpr double kResidualFloor = 4e-16;

}  // namespace

PinholeRadtan PinholeRadtan::from(const Intrinsics& intrinsics) {
  const auto& d = intrinsics.distortion;
  return {d[0], d[1], d[2], d[3]};
}

Vec2 PinholeRadtan::distort(const Vec2& m, Mat22* J) const {
  const Vec2 q(p2, p1);
  const double r2 = m.squaredNorm(), qm = q.dot(m);
  const double radial = 1 + r2 * (k1 + r2 * k2);
  if (J != nullptr) {
    *J = (2 * k1 + 4 * k2 * r2) * m * m.transpose() + 2 * (m * q.transpose() + q * m.transpose());
    J->diagonal().array() += radial + 2 * qm;
  }
  return (radial + 2 * qm) * m + r2 * q;
}

Eigen::Matrix<double, 2, kDistortionCount> PinholeRadtan::parameter_jacobian(const Vec2& m) {
  const double x = m.x(), y = m.y(), r2 = m.squaredNorm();
  Eigen::Matrix<double, 2, kDistortionCount> J;
  J << x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x,  //
      y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y;
  return J;
}

double PinholeRadtan::max_radius(double max_distorted_radius) const {
  // At radius r the radial part has eigenvalues A = 1 + 3 k1 r^2 + 5 k2 r^4 along the radius and B = 1 + k1 r^2 +
  // k2 r^4 across; the tangential part 2 (m q^T + q m^T + (q . m) I) has none below -6 |q| r. So the smallest
  // eigenvalue is at least min(A, B) - 6 |q| r, and that is exact for barrel distortion.
  const double tangential = 6 * std::hypot(p1, p2);
  const double along[] = {1 - kMinSlope, -tangential, 3 * k1, 0, 5 * k2};
  const double across[] = {1 - kMinSlope, -tangential, k1, 0, k2};
  const double reach[] = {max_distorted_radius, -1, 0, -k1, 0, -k2};
  double radius = std::tan(kMaxAngleRad);
  radius = first_non_positive(along, radius);
  radius = first_non_positive(across, radius);
  return first_non_positive(reach, radius);
}

bool PinholeRadtan::undistort(const Vec2& m_d, double max_radius, Vec2& m) const {
  const double r_d = m_d.norm();
  const auto radial = [this](double r) {
    const double r2 = r * r;
    return ValueAndSlope{r * (1 + r2 * (k1 + r2 * k2)), 1 + r2 * (3 * k1 + r2 * 5 * k2)};
  };
  if (p1 == 0 && p2 == 0 && r_d > radial(max_radius).value * (1 + kEdgeTolerance)) return false;
  Vec2 guess = m_d;
  if (r_d > 0) guess *= solve_radial(radial, r_d, max_radius) / r_d;

  // Newton on the whole distortion: descent on a strictly convex potential, so halving the step always helps. A step
  // over the edge is cut there; an answer beyond the edge leaves a residual that no round can lower.
  Mat22 J;
  Vec2 residual = distort(guess, &J) - m_d;
  const double floor = kResidualFloor * (1 + r_d);
  for (int round = 0; round < kMaxRounds && residual.norm() > floor; ++round) {
    const double det = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
    const Vec2 step(-(J(1, 1) * residual.x() - J(0, 1) * residual.y()) / det,
                    -(J(0, 0) * residual.y() - J(1, 0) * residual.x()) / det);
    bool lower = false;
    for (double scale = 1; scale > 1e-3 && !lower; scale *= 0.5) {
      Vec2 next = guess + scale * step;
      if (next.norm() > max_radius) next *= max_radius / next.norm();
      Mat22 J_next;
      const Vec2 next_residual = distort(next, &J_next) - m_d;
      if (next_residual.norm() >= residual.norm()) continue;
      guess = next;
      residual = next_residual;
      J = J_next;
      lower = true;
    }
    if (!lower) break;
  }
  if (!(residual.norm() <= kEdgeTolerance * (1 + r_d))) return false;
  m = guess;
  return true;
}

}  // namespace roomcal::camera
