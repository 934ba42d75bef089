#include "runtime/marker/conic.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace roomcal::marker {
namespace {

constexpr int kFewestPoints = 10;

Conic monomials(const Vec2& p) {
  Conic row;
  row << p.x() * p.x(), p.x() * p.y(), p.y() * p.y(), p.x(), p.y();
  return row;
}

}  // namespace

Conic unit_circle() {
  Conic circle;
  circle << 1, 0, 1, 0, 0;
  return circle;
}

double conic_value(const Conic& conic, const Vec2& point) { return monomials(point).dot(conic); }

bool fit_conic(std::span<const Vec2> point, double limit, Conic& conic) {
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Conic right = Conic::Zero();
  int used = 0;
  for (const Vec2& p : point) {
    const Conic row = monomials(p);
    if (std::abs(row.dot(conic) - 1) > limit) continue;
    normal += row * row.transpose();
    right += row;
    ++used;
  }
  if (used < kFewestPoints) return false;
  const Eigen::LDLT<Eigen::Matrix<double, 5, 5>> solver(normal);
  if (solver.info() != Eigen::Success || solver.rcond() < 1e-7) return false;
  conic = solver.solve(right);
  return true;
}

bool conic_ellipse(const Conic& conic, Vec2& centre, Mat22& S2) {
  Mat22 Q;
  Q << conic[0], conic[1] / 2, conic[1] / 2, conic[2];
  if (Q.determinant() <= 1e-9 || Q.trace() <= 0) return false;
  const Mat22 Q_inverse = Q.inverse();
  centre = -0.5 * (Q_inverse * Vec2(conic[3], conic[4]));
  const double level = 1 + centre.dot(Q * centre);
  if (level <= 0) return false;
  S2 = Q_inverse * level;
  return true;
}

}  // namespace roomcal::marker
