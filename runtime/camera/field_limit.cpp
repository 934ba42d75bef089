#include "runtime/camera/field_limit.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "runtime/base/fixed_vector.h"

namespace roomcal::camera {

namespace {

constexpr std::size_t kMaxDegree = 9;
using Coefficients = std::array<double, kMaxDegree + 1>;
using Breaks = FixedVector<double, kMaxDegree + 2>;

double evaluate(const Coefficients& c, std::size_t degree, double x) {
  double value = c[degree];
  for (std::size_t i = degree; i-- > 0;) value = value * x + c[i];
  return value;
}

// The k-th derivative's coefficients, up to a positive factor that keeps them small.
Coefficients derivative(std::span<const double> c, std::size_t order) {
  Coefficients out{};
  for (std::size_t i = order; i < c.size(); ++i) {
    double factor = 1;
    for (std::size_t j = 0; j < order; ++j) factor *= static_cast<double>(i - j) / static_cast<double>(order);
    out[i - order] = factor * c[i];
  }
  return out;
}

// Root in [a, b] with opposite signs at the ends, by bisection to the last bit: create() has the time.
double bisect(const Coefficients& c, std::size_t degree, double a, double b) {
  const bool rising = evaluate(c, degree, b) > 0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (a + b);
    if (middle <= a || middle >= b) break;
    ((evaluate(c, degree, middle) > 0) == rising ? b : a) = middle;
  }
  return a;
}

// The interval's ends and the roots of the polynomial between them, given the breaks of its derivative.
Breaks roots_between(const Coefficients& c, std::size_t degree, const Breaks& breaks) {
  Breaks roots;
  [[maybe_unused]] bool kept = roots.push_back(breaks[0]);
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double left = evaluate(c, degree, breaks[i]), right = evaluate(c, degree, breaks[i + 1]);
    if ((left > 0) != (right > 0)) kept = roots.push_back(bisect(c, degree, breaks[i], breaks[i + 1]));
  }
  kept = roots.push_back(breaks.back());
  assert(kept);
  return roots;
}

}  // namespace

double first_non_positive(std::span<const double> coefficients, double upper) {
  assert(!coefficients.empty() && coefficients.size() <= kMaxDegree + 1);
  const std::size_t degree = coefficients.size() - 1;
  Breaks breaks;
  [[maybe_unused]] const bool kept = breaks.push_back(0) && breaks.push_back(upper);
  assert(kept);
  for (std::size_t order = degree; order-- > 1;)
    breaks = roots_between(derivative(coefficients, order), degree - order, breaks);
  const Coefficients c = derivative(coefficients, 0);
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i)
    if (evaluate(c, degree, breaks[i + 1]) <= 0) return bisect(c, degree, breaks[i], breaks[i + 1]);
  return upper;
}

double corner_radius(const Intrinsics& intrinsics) {
  double radius = 0;
  for (const double x_px : {-0.5, intrinsics.width_px - 0.5})
    for (const double y_px : {-0.5, intrinsics.height_px - 0.5})
      radius = std::max(radius, std::hypot((x_px - intrinsics.cx_px) / intrinsics.fx_px,
                                           (y_px - intrinsics.cy_px) / intrinsics.fy_px));
  return radius;
}

}  // namespace roomcal::camera
