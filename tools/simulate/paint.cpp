#include "tools/simulate/paint.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace roomcal::tools {

namespace {

constexpr double kCell_m = 0.1;
constexpr double kJointHalfWidth_m = 0.0015;
constexpr double kJointAlbedo = 0.12;
constexpr int kFanBlades = 8;

/// Share of a sample on the inner side of an edge that runs `inside_m` further out.
double coverage(double inside_m, double samples_per_m) { return std::clamp(0.5 + inside_m * samples_per_m, 0.0, 1.0); }

/// Metres per pixel across an edge whose normal on the plane is `direction` (unit).
double spacing(const Mat22& footprint, const Vec2& direction) { return (footprint.transpose() * direction).norm(); }

/// Share of ink within circles that alternate ink, paper, ink... from the outside.
Paint ink_of_rings(std::span<const double> radii, const Decal& decal, const Vec2& local, const Mat22& footprint,
                   double sample_px) {
  const double r = local.norm();
  const double scale = spacing(footprint, r > 0 ? Vec2(local / r) : Vec2(1, 0));
  const double samples_per_m = 1 / (scale * sample_px);
  double share = 0, nearest_m = 1e9, sign = 1;
  for (const double fraction : radii) {
    const double inside_m = fraction * decal.radius_m - r;
    share += sign * coverage(inside_m, samples_per_m);
    nearest_m = std::min(nearest_m, std::abs(inside_m));
    sign = -sign;
  }
  return {share, nearest_m / scale};
}

Paint ink_of_fan(const Decal& decal, const Vec2& local) {
  const double turns = std::atan2(local.y(), local.x()) / (2 * kPi) * kFanBlades + local.norm() / decal.radius_m;
  const bool dark = local.norm() < decal.radius_m && turns - std::floor(turns) < 0.5;
  return {dark ? 1.0 : 0.0, local.norm() < 1.1 * decal.radius_m ? 0.0 : 1e9};
}

/// Rows of dashes of random length, like printed text.
Paint ink_of_stripes(const Decal& decal, const Vec2& local) {
  if (local.cwiseAbs().maxCoeff() > decal.radius_m) return {0, 1e9};
  const double line = std::floor((local.y() / decal.radius_m + 1) * 6);
  const double in_line = (local.y() / decal.radius_m + 1) * 6 - line;
  const double word = std::sin(31 * local.x() / decal.radius_m + 17 * line) + std::sin(12 * local.x() / decal.radius_m);
  return {in_line < 0.55 && word > -0.3 ? 1.0 : 0.0, 0};
}

Paint ink_of(const Decal& decal, const Vec2& local, const Mat22& footprint, double sample_px) {
  static constexpr std::array<double, 1> kDisc = {1.0};
  static constexpr std::array<double, 2> kOneRing = {1.0, 0.7};
  static constexpr std::array<double, 4> kTwoRings = {1.0, 0.8, 0.6, 0.4};
  switch (decal.print) {
    case Print::kRings:
      return ink_of_rings(decal.ring_radii, decal, local, footprint, sample_px);
    case Print::kDisc:
      return ink_of_rings(kDisc, decal, local, footprint, sample_px);
    case Print::kOneRing:
      return ink_of_rings(kOneRing, decal, local, footprint, sample_px);
    case Print::kTwoRings:
      return ink_of_rings(kTwoRings, decal, local, footprint, sample_px);
    case Print::kFan:
      return ink_of_fan(decal, local);
    case Print::kStripes:
      return ink_of_stripes(decal, local);
  }
  return {};
}

double hash01(int64_t x, int64_t y, uint64_t seed) {
  uint64_t h = seed ^ static_cast<uint64_t>(x) * 0x9E3779B97F4A7C15u ^ static_cast<uint64_t>(y) * 0xC2B2AE3D27D4EB4Fu;
  h = (h ^ (h >> 29)) * 0xBF58476D1CE4E5B9u;
  return static_cast<double>((h ^ (h >> 32)) >> 11) * 0x1.0p-53;
}

/// Smooth noise in [-1, 1] with features of size 1.
double stain(const Vec2& p, uint64_t seed) {
  const double fx = std::floor(p.x()), fy = std::floor(p.y());
  const auto ix = static_cast<int64_t>(fx), iy = static_cast<int64_t>(fy);
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double tx = ease(p.x() - fx), ty = ease(p.y() - fy);
  const double low = std::lerp(hash01(ix, iy, seed), hash01(ix + 1, iy, seed), tx);
  const double high = std::lerp(hash01(ix, iy + 1, seed), hash01(ix + 1, iy + 1, seed), tx);
  return 2 * std::lerp(low, high, ty) - 1;
}

}  // namespace

PaintedDecal::PaintedDecal(const Decal& decal) : decal_(decal) {
  const double c = std::cos(decal.angle_rad), s = std::sin(decal.angle_rad);
  R_decal_plane_ << c, s, -s, c;
}

Paint PaintedDecal::over(const Paint& below, const Vec2& q, const Mat22& footprint, double sample_px) const {
  const Vec2 local = R_decal_plane_ * (q - decal_.centre);
  const Mat22 local_footprint = R_decal_plane_ * footprint;

  const Vec2 inside = decal_.half_size - local.cwiseAbs();
  const Vec2 inside_px(inside.x() / spacing(local_footprint, Vec2(1, 0)),
                       inside.y() / spacing(local_footprint, Vec2(0, 1)));
  const double edge_px = inside_px.minCoeff();
  if (edge_px < -2) return below;
  const double paper =
      std::clamp(0.5 + inside_px.x() / sample_px, 0.0, 1.0) * std::clamp(0.5 + inside_px.y() / sample_px, 0.0, 1.0);

  const Paint ink = ink_of(decal_, local, local_footprint, sample_px);
  const double printed = std::lerp(kPaperAlbedo, kInkAlbedo, ink.albedo);
  return {std::lerp(below.albedo, printed, paper), std::min({below.edge_px, std::abs(edge_px), ink.edge_px})};
}

PaintedPlane::PaintedPlane(const Plane& plane, uint64_t seed)
    : plane_(plane),
      seed_(seed),
      columns_(static_cast<int>(plane.size.x() / kCell_m) + 1),
      rows_(static_cast<int>(plane.size.y() / kCell_m) + 1),
      decals_near_(static_cast<std::size_t>(columns_ * rows_)) {
  for (std::size_t i = 0; i < plane.decals.size(); ++i) {
    const Decal& decal = plane.decals[i];
    decals_.emplace_back(decal);
    const double reach = decal.half_size.norm() + kCell_m;  // an edge is felt a pixel away, and a cell is a square
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const Vec2 middle((column + 0.5) * kCell_m, (row + 0.5) * kCell_m);
        if ((middle - decal.centre).norm() > reach) continue;
        decals_near_[static_cast<std::size_t>(row * columns_ + column)].push_back(static_cast<uint16_t>(i));
      }
    }
  }
}

int PaintedPlane::cell_of(const Vec2& q) const {
  const int column = std::clamp(static_cast<int>(q.x() / kCell_m), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(q.y() / kCell_m), 0, rows_ - 1);
  return row * columns_ + column;
}

Paint PaintedPlane::background(const Vec2& q, const Mat22& footprint) const {
  const double grain = 0.05 * stain(q * 7, seed_) + 0.03 * stain(q * 31, seed_ + 1);
  Paint paint{plane_.albedo * (1 + grain), 1e9};
  if (plane_.tile_m <= 0) return paint;
  for (int i = 0; i < 2; ++i) {
    const double to_joint = std::abs(q[i] / plane_.tile_m - std::round(q[i] / plane_.tile_m)) * plane_.tile_m;
    const double edge_m = std::abs(to_joint - kJointHalfWidth_m);
    paint.edge_px = std::min(paint.edge_px, edge_m / spacing(footprint, i == 0 ? Vec2(1, 0) : Vec2(0, 1)));
    if (to_joint < kJointHalfWidth_m) paint.albedo = kJointAlbedo;
  }
  return paint;
}

Paint PaintedPlane::at(const Vec2& q, const Mat22& footprint, double sample_px) const {
  Paint paint = background(q, footprint);
  for (const uint16_t i : decals_near_[static_cast<std::size_t>(cell_of(q))]) {
    paint = decals_[i].over(paint, q, footprint, sample_px);
  }
  return paint;
}

}  // namespace roomcal::tools
