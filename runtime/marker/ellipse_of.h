#pragma once

#include "runtime/base/span2d.h"
#include "runtime/marker/detector.h"
#include "runtime/math/types.h"

namespace roomcal::marker {

/// Axes and angle of (p - centre)^T S2^-1 (p - centre) = 1.
Ellipse ellipse_of(const Vec2& centre_px, const Mat22& S2_px2);

/// Square of a point's distance from an ellipse's centre, in semi-axes: 1 on the ellipse.
double radius2_in(const Ellipse& ellipse, const Vec2& point_px);

/// Does that ellipse leave the image, or come within half a pixel of it?
bool crosses_border(ImageView image, const Vec2& centre_px, const Mat22& S2_px2);

}  // namespace roomcal::marker
