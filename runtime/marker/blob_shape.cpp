#include "runtime/marker/blob_shape.h"

#include <algorithm>
#include <cmath>

#include "runtime/math/types.h"

namespace roomcal::marker {
namespace {

/// Largest dark blob that may be a whole marker whose inside the threshold did not resolve, half axis in px.
constexpr double kMaxUnresolvedHalfPx = 24;

double square(double v) { return v * v; }

/// Eigenvalues of S^2, larger first.
void eigenvalues(const Blob& b, double& large, double& small) {
  const double mean = (b.sxx + b.syy) / 2;
  const double spread = std::sqrt(square((b.sxx - b.syy) / 2) + square(b.sxy));
  large = mean + spread;
  small = std::max(mean - spread, 0.0);
}

}  // namespace

bool fit_blob(const Extent& e, Blob& blob) {
  // Half widths of the region's area: pixels are squares of side 1, whose own half width along a diagonal, in units
  // of x + y, would be 1; the boundary passes between pixel centres, so half of it is right for both.
  const double hx = (e.x_max - e.x_min + 1) / 2.0;
  const double hy = (e.y_max - e.y_min + 1) / 2.0;
  const double hs = (e.sum_max - e.sum_min + 1) / 2.0;
  const double hd = (e.diff_max - e.diff_min + 1) / 2.0;
  const double cx = (e.x_min + e.x_max) / 2.0;
  const double cy = (e.y_min + e.y_max) / 2.0;
  const double cs = (e.sum_min + e.sum_max) / 2.0;
  const double cd = (e.diff_min + e.diff_max) / 2.0;

  const double size = std::max(hx, hy);
  const double centre_limit = 0.8 + 0.08 * size;
  if (std::abs(cs - cx - cy) > centre_limit || std::abs(cd - cx + cy) > centre_limit) return false;

  // (hs^2 + hd^2) / 2 = sxx + syy. Steps of a pixel move each width by about half of one.
  const double straight = square(hx) + square(hy);
  const double diagonal = (square(hs) + square(hd)) / 2;
  if (std::abs(straight - diagonal) > 0.16 * straight + 1.2 * size) return false;
  const double gap = (straight - diagonal) / 4;  // least squares over the four widths, each equation weighted alike
  blob.sxx = square(hx) - gap;
  blob.syy = square(hy) - gap;
  blob.sxy = (square(hs) - square(hd)) / 4;
  blob.x = (cx + (cs + cd) / 2) / 2;
  blob.y = (cy + (cs - cd) / 2) / 2;
  double large = 0;
  double small = 0;
  eigenvalues(blob, large, small);
  if (large <= 0) return false;
  // Slant 75 degrees is a ratio of 0.26; pixel steps may take thin ones to the other side of zero.
  const double least = std::max(0.25, square(0.15) * large);
  if (small < least) {
    if (small < -1.0 || size > 20) return false;
    blob.sxx += least - small;
    blob.syy += least - small;
  }
  return true;
}

bool concentric(const Blob& outer, const Blob& inner) {
  const double outer_size = outer.sxx + outer.syy;
  const double inner_size = inner.sxx + inner.syy;
  if (inner_size >= outer_size) return false;
  // Distance in the outer ellipse's own metric: (d^T S^-2 d).
  const double det = outer.sxx * outer.syy - square(outer.sxy);
  if (det <= 0) return false;
  const double dx = inner.x - outer.x;
  const double dy = inner.y - outer.y;
  const double distance2 = (outer.syy * dx * dx - 2 * outer.sxy * dx * dy + outer.sxx * dy * dy) / det;
  if (distance2 > square(0.16) && square(dx) + square(dy) > square(0.8)) return false;
  // Shapes: the components of S^2 per size, with room for pixel steps of small inner blobs.
  const double slack = 0.18 + 1.2 / std::sqrt(inner_size);
  return std::abs(inner.sxx / inner_size - outer.sxx / outer_size) < slack &&
         std::abs(inner.sxy / inner_size - outer.sxy / outer_size) < slack;
}

bool worth_keeping_alone(const Blob& blob, int area_px) {
  // A dark ring with a gap counts as alone, too: the light inside is then no region of its own, and the area is thin.
  if (blob.dark) return half_major(blob) >= 5 && half_major(blob) <= kMaxUnresolvedHalfPx;
  // A light disc may still get its dark ring; specks of some pixels have no shape to judge by.
  if (half_minor(blob) < 2.5) return true;
  return area_px >= 0.75 * kPi * std::sqrt(std::max(blob.sxx * blob.syy - square(blob.sxy), 0.0));
}

double half_major(const Blob& blob) {
  double large = 0;
  double small = 0;
  eigenvalues(blob, large, small);
  return std::sqrt(large);
}

double half_minor(const Blob& blob) {
  double large = 0;
  double small = 0;
  eigenvalues(blob, large, small);
  return std::sqrt(small);
}

}  // namespace roomcal::marker
