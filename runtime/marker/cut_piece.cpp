#include "runtime/marker/cut_piece.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "runtime/base/fixed_vector.h"
#include "runtime/marker/conic.h"

namespace roomcal::marker {
namespace {

constexpr std::size_t kLongestOutline = 4096;
constexpr std::size_t kFitPoints = 48;
constexpr int kShortestArc = 14;  ///< px of outline: a third of the innermost circle of a 25 px marker

struct Pixel {
  int16_t x = 0;
  int16_t y = 0;
};

using Outline = FixedVector<Pixel, kLongestOutline>;

/// The eight neighbours, clockwise in the image from west.
constexpr std::array<std::array<int, 2>, 8> kAround = {
    {{-1, 0}, {-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}}};

bool belongs(ImageView image, const ThresholdMap& map, bool dark, int x, int y) {
  return x >= 0 && y >= 0 && x < image.width() && y < image.height() && map.dark(image, x, y) == dark;
}

/// Moore neighbour tracing from the region's topmost run. @return false if the outline is longer than the array.
bool trace(ImageView image, const ThresholdMap& map, const CutPiece& piece, Outline& outline) {
  int x = piece.seed_x;
  int y = piece.seed_y;
  std::size_t from = 0;  // the neighbour we came from: west of the topmost leftmost pixel is outside
  while (true) {
    if (!outline.push_back({static_cast<int16_t>(x), static_cast<int16_t>(y)})) return false;
    std::size_t turn = 1;
    while (turn < 8 &&
           !belongs(image, map, piece.dark, x + kAround[(from + turn) % 8][0], y + kAround[(from + turn) % 8][1]))
      ++turn;
    if (turn == 8) return true;  // a single pixel
    const std::size_t step = (from + turn) % 8;
    x += kAround[step][0];
    y += kAround[step][1];
    // Back to the last outside neighbour, seen from the new pixel.
    from = (step + (step % 2 == 0 ? 6U : 5U)) % 8;
    if (x == piece.seed_x && y == piece.seed_y) return true;
  }
}

bool at_border(ImageView image, Pixel p) {
  return p.x == 0 || p.y == 0 || p.x == image.width() - 1 || p.y == image.height() - 1;
}

/// A marker lies in a corner at the most; what touches more sides is the background.
int sides_touched(ImageView image, const Extent& e) {
  return (e.x_min == 0 ? 1 : 0) + (e.y_min == 0 ? 1 : 0) + (e.x_max == image.width() - 1 ? 1 : 0) +
         (e.y_max == image.height() - 1 ? 1 : 0);
}

struct Arc {
  std::size_t first = 0;
  std::size_t length = 0;
};

/// The longest stretch of the closed outline that keeps off the border.
Arc longest_arc(ImageView image, const Outline& outline) {
  const std::size_t size = outline.size();
  std::size_t start = 0;
  while (start < size && !at_border(image, outline[start])) ++start;
  Arc longest;
  Arc arc;
  for (std::size_t i = 1; i <= size; ++i) {
    const std::size_t at = (start + i) % size;
    if (at_border(image, outline[at])) {
      arc.length = 0;
      continue;
    }
    if (arc.length++ == 0) arc.first = at;
    if (arc.length > longest.length) longest = arc;
  }
  return longest;
}

}  // namespace

bool fit_cut_piece(ImageView image, const ThresholdMap& map, const CutPiece& piece, Blob& blob) {
  if (sides_touched(image, piece.extent) > 2) return false;
  Outline outline;
  if (!trace(image, map, piece, outline)) return false;
  const Arc arc = longest_arc(image, outline);
  if (arc.length < kShortestArc) return false;
  const std::size_t count = std::min(arc.length, kFitPoints);
  std::array<Vec2, kFitPoints> store;
  const std::span<Vec2> points(store.data(), count);
  Vec2 mean = Vec2::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const Pixel p = outline[(arc.first + i * arc.length / count) % outline.size()];
    points[i] = Vec2(p.x, p.y);
    mean += points[i] / static_cast<double>(count);
  }
  double scale = 0;
  for (const Vec2& point : points) scale = std::max(scale, (point - mean).norm());
  for (Vec2& point : points) point = (point - mean) / scale;
  Conic conic = unit_circle();
  if (!fit_conic(points, 1e9, conic) || !fit_conic(points, 0.3, conic)) return false;
  const double near = 0.06 + 1.6 / scale;
  const auto inliers = std::count_if(points.begin(), points.end(), [&conic, near](const Vec2& point) {
    return std::abs(conic_value(conic, point) - 1) < near;
  });
  Vec2 centre;
  Mat22 S2;
  if (static_cast<double>(inliers) < 0.75 * static_cast<double>(count) || !conic_ellipse(conic, centre, S2))
    return false;
  // An arc much smaller than its ellipse says little about it.
  if (S2.trace() > 16) return false;
  const Vec2 centre_px = mean + scale * centre;
  if (centre_px.x() < 0 || centre_px.y() < 0 || centre_px.x() >= image.width() || centre_px.y() >= image.height())
    return false;
  blob = {};
  blob.x = centre_px.x();
  blob.y = centre_px.y();
  // The outline's pixels lie half a pixel inside the boundary.
  const double grow = scale * scale * (1 + 1 / scale);
  blob.sxx = S2(0, 0) * grow;
  blob.sxy = S2(0, 1) * grow;
  blob.syy = S2(1, 1) * grow;
  blob.dark = piece.dark;
  blob.dark_depth = piece.dark ? 1 : 0;
  return true;
}

}  // namespace roomcal::marker
