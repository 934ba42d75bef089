#pragma once

#include <array>

#include "runtime/base/fixed_vector.h"

namespace roomcal::pose {

/// Real roots of  c[0] x^4 + c[1] x^3 + c[2] x^2 + c[3] x + c[4] = 0.
///
/// Ferrari's factorization into two quadratics by a real root of the resolvent cubic, then two Newton steps a root. A
/// double root that rounding has made complex is kept; roots come in no order, a double root twice. A leading
/// coefficient that vanishes beside the others leaves the cubic, the quadratic or the line below it.
/// @param[out] roots  cleared first; empty if nothing is finite or no root is real.
/// Cost: constant, one cube root or one arc cosine.
void solve_quartic(const std::array<double, 5>& c, FixedVector<double, 4>& roots);

}  // namespace roomcal::pose
