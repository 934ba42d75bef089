#pragma once

#include <span>

#include "runtime/camera/intrinsics.h"

namespace roomcal::camera {

/// A model's field ends where its radial slope has fallen to this, a hair in front of the fold itself: there a pixel's
/// rounding (1e-13 px at f = 300 px) still moves the ray by less than 1e-12 rad.
inline constexpr double kMinSlope = 1e-3;

/// The field ends at this many times the distance of the farthest image corner: nothing is measured out there, and
/// polynomials grow until a pixel is too coarse a double for the 1e-9 px that the round trip promises.
inline constexpr double kMaxCornerRadii = 10;

/// A lens that folds inside this part of the image is a wrong set of parameters, not a lens.
inline constexpr double kMinCornerRadii = 0.1;

/// Smallest x in (0, upper] at which the polynomial sum c[i] x^i is <= 0; `upper` if there is none. Wants c[0] > 0.
///
/// Exact in the sense that no root can slip between samples: the roots of each derivative split the interval into
/// monotone pieces for the next lower one. Degree at most 9.
double first_non_positive(std::span<const double> coefficients, double upper);

/// Distance of the farthest image corner from the principal point in the normalized plane (dimensionless).
double corner_radius(const Intrinsics& intrinsics);

}  // namespace roomcal::camera
