#pragma once

#include <cmath>

namespace roomcal::camera {

/// A radial function's value and its derivative at one argument.
struct ValueAndSlope {
  double value;
  double slope;
};

/// Relative slack at the edge of the field, so that what project() put on the edge is found again.
inline constexpr double kEdgeTolerance = 1e-13;

/// x in [0, upper] with f(x) = target, for f rising on that interval from f(0) = 0.
///
/// Newton, with bisection where a step leaves the bracket; a target beyond f(upper) gives upper.
/// @param f  callable double -> ValueAndSlope.
/// Cost: at most 80 evaluations; 4 to 6 for a lens.
template <typename F>
double solve_radial(const F& f, double target, double upper) {
  double low = 0, high = upper;
  double x = target < upper ? target : upper;
  for (int round = 0; round < 80; ++round) {
    const ValueAndSlope at = f(x);
    const double error = at.value - target;
    if (error == 0) return x;
    (error > 0 ? high : low) = x;
    double next = x - error / at.slope;
    if (!(next > low && next < high)) {
      // A Newton step that rounding pushed onto the bracket's end is an answer; a wild one is bisected.
      if (std::abs(error) <= 1e-15 * target) return x;
      next = 0.5 * (low + high);
      if (next <= low || next >= high) return x;
    }
    if (std::abs(next - x) <= 1e-16 * x) return next;
    x = next;
  }
  return x;
}

}  // namespace roomcal::camera
