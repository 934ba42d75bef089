#pragma once

#include <span>

#include "runtime/math/types.h"

namespace roomcal::marker {

/// Conic a x^2 + b x y + c y^2 + d x + e y = 1, as (a, b, c, d, e): any ellipse that has the origin inside.
using Conic = Eigen::Matrix<double, 5, 1>;

/// The unit circle, where fits begin.
Conic unit_circle();

/// Left side of the conic's equation; near the conic it differs from 1 by twice the relative distance.
double conic_value(const Conic& conic, const Vec2& point);

/// Least squares over the points whose value under the conic given is within `limit` of 1.
/// @param point  coordinates of order one, origin inside the ellipse.
/// @return false, conic unchanged, for fewer than ten such points or points that leave the conic open.
bool fit_conic(std::span<const Vec2> point, double limit, Conic& conic);

/// Ellipse (p - centre)^T S2^-1 (p - centre) = 1 of a conic. @return false if it is not an ellipse.
bool conic_ellipse(const Conic& conic, Vec2& centre, Mat22& S2);

}  // namespace roomcal::marker
