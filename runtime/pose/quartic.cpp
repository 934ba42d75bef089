#include "runtime/pose/quartic.h"

#include <algorithm>
#include <cmath>

namespace roomcal::pose {
namespace {

/// Imaginary parts below this, relative to the size of the root, are rounding: a double root. Chosen at the square
/// root of the double's precision, because a double root moves by the root of a coefficient's error.
constexpr double kDoubleRoot = 1e-7;

void push_quadratic(double b, double c, double shift, FixedVector<double, 4>& roots) {
  // x^2 + b x + c
  const double discriminant = 0.25 * b * b - c;
  const double scale = std::max(0.25 * b * b, std::abs(c)) + shift * shift;
  if (discriminant < -kDoubleRoot * scale) return;
  const double root = std::sqrt(std::max(discriminant, 0.0));
  // The larger root first, the smaller by the product: no cancellation.
  const double first = b > 0 ? -0.5 * b - root : -0.5 * b + root;
  const double second = first != 0.0 ? c / first : 0.0;
  static_cast<void>(roots.push_back(first + shift));
  static_cast<void>(roots.push_back(second + shift));
}

/// The largest real root of  z^3 + a z^2 + b z + c.
double largest_cubic_root(double a, double b, double c) {
  const double q = (a * a - 3.0 * b) / 9.0;
  const double r = (a * (2.0 * a * a - 9.0 * b) + 27.0 * c) / 54.0;
  const double q3 = q * q * q;
  if (r * r < q3) {
    const double theta = std::acos(std::clamp(r / std::sqrt(q3), -1.0, 1.0));
    // Largest of -2 sqrt(q) cos((theta + 2 pi k) / 3): k = 1.
    return -2.0 * std::sqrt(q) * std::cos((theta + 6.283185307179586) / 3.0) - a / 3.0;
  }
  const double s = -std::copysign(std::cbrt(std::abs(r) + std::sqrt(std::max(r * r - q3, 0.0))), r);
  const double t = s != 0.0 ? q / s : 0.0;
  return s + t - a / 3.0;
}

void solve_cubic(double b, double c, double d, FixedVector<double, 4>& roots) {
  const double z = largest_cubic_root(b, c, d);
  static_cast<void>(roots.push_back(z));
  push_quadratic(b + z, c + z * (b + z), 0.0, roots);
}

void solve_low_degree(const std::array<double, 5>& c, double scale, FixedVector<double, 4>& roots) {
  const double tiny = 1e-14 * scale;
  if (std::abs(c[1]) > tiny) {
    solve_cubic(c[2] / c[1], c[3] / c[1], c[4] / c[1], roots);
  } else if (std::abs(c[2]) > tiny) {
    push_quadratic(c[3] / c[2], c[4] / c[2], 0.0, roots);
  } else if (std::abs(c[3]) > tiny) {
    static_cast<void>(roots.push_back(-c[4] / c[3]));
  }
}

double newton(const std::array<double, 5>& c, double x) {
  for (int round = 0; round < 2; ++round) {
    const double value = (((c[0] * x + c[1]) * x + c[2]) * x + c[3]) * x + c[4];
    const double slope = ((4.0 * c[0] * x + 3.0 * c[1]) * x + 2.0 * c[2]) * x + c[3];
    const double step = value / slope;
    // At a double root the slope vanishes; a wild step would leave the root that we have.
    if (!(std::abs(step) < 0.05 * (1.0 + std::abs(x)))) return x;
    x -= step;
  }
  return x;
}

void solve_depressed(double p, double q, double r, double shift, FixedVector<double, 4>& roots) {
  // y^4 + p y^2 + q y + r = (y^2 + s y + u)(y^2 - s y + v) with s^2 = z a root of the resolvent.
  const double z = largest_cubic_root(2.0 * p, p * p - 4.0 * r, -q * q);
  if (z <= 1e-14 * (std::abs(p) + std::sqrt(std::abs(r)))) {  // biquadratic
    const double discriminant = 0.25 * p * p - r;
    if (discriminant < -kDoubleRoot * (p * p + std::abs(r))) return;
    const double root = std::sqrt(std::max(discriminant, 0.0));
    push_quadratic(0.0, 0.5 * p - root, shift, roots);
    push_quadratic(0.0, 0.5 * p + root, shift, roots);
    return;
  }
  const double s = std::sqrt(z);
  push_quadratic(s, 0.5 * (p + z - q / s), shift, roots);
  push_quadratic(-s, 0.5 * (p + z + q / s), shift, roots);
}

}  // namespace

void solve_quartic(const std::array<double, 5>& c, FixedVector<double, 4>& roots) {
  roots.clear();
  double scale = 0;
  for (const double coefficient : c) {
    if (!std::isfinite(coefficient)) return;
    scale = std::max(scale, std::abs(coefficient));
  }
  if (std::abs(c[0]) <= 1e-14 * scale) {
    solve_low_degree(c, scale, roots);
  } else {
    const double b = c[1] / c[0];
    const double d = c[2] / c[0];
    const double e = c[3] / c[0];
    const double f = c[4] / c[0];
    const double b2 = b * b;
    solve_depressed(d - 0.375 * b2, e - 0.5 * b * d + 0.125 * b * b2,
                    f - 0.25 * b * e + 0.0625 * b2 * d - 3.0 / 256.0 * b2 * b2, -0.25 * b, roots);
  }
  for (double& root : roots) root = newton(c, root);
}

}  // namespace roomcal::pose
