#include "tools/simulate/paint.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "tools/common/error.h"

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

bool PaintedDecal::near(const Vec2& q, const Mat22& footprint, double reach_px) const {
  const Vec2 local = R_decal_plane_ * (q - decal_.centre);
  // No direction is spaced wider than the footprint's norm.
  return (decal_.half_size - local.cwiseAbs()).minCoeff() >= -reach_px * footprint.norm();
}

DecalFootprint PaintedDecal::footprint_of(const Mat22& footprint) const {
  const Mat22 local = R_decal_plane_ * footprint;
  return {local, spacing(local, Vec2(1, 0)), spacing(local, Vec2(0, 1))};
}

bool PaintedDecal::look(const Vec2& q, const DecalFootprint& footprint, double sample_px, Layer& layer) const {
  const Vec2 local = R_decal_plane_ * (q - decal_.centre);
  const Vec2 inside = decal_.half_size - local.cwiseAbs();
  const Vec2 inside_px(inside.x() / footprint.across_m, inside.y() / footprint.up_m);
  const double edge_px = inside_px.minCoeff();
  if (edge_px < -2) return false;
  layer.paper =
      std::clamp(0.5 + inside_px.x() / sample_px, 0.0, 1.0) * std::clamp(0.5 + inside_px.y() / sample_px, 0.0, 1.0);
  const Paint ink = ink_of(decal_, local, footprint.local, sample_px);
  layer.albedo = std::lerp(kPaperAlbedo, kInkAlbedo, ink.albedo);
  layer.edge_px = std::min(std::abs(edge_px), ink.edge_px);
  return true;
}

Paint PaintedDecal::over(const Paint& below, const Vec2& q, const Mat22& footprint, double sample_px) const {
  Layer layer;
  if (!look(q, footprint_of(footprint), sample_px, layer)) return below;
  return {std::lerp(below.albedo, layer.albedo, layer.paper), std::min(below.edge_px, layer.edge_px)};
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
        auto& cell = decals_near_[static_cast<std::size_t>(row * columns_ + column)];
        cell.push_back(static_cast<uint16_t>(i));
        if (cell.size() > kMostNear) throw ToolError(plane.name + ": too many sheets in one place");
      }
    }
  }
}

int PaintedPlane::cell_of(const Vec2& q) const {
  const int column = std::clamp(static_cast<int>(q.x() / kCell_m), 0, columns_ - 1);
  const int row = std::clamp(static_cast<int>(q.y() / kCell_m), 0, rows_ - 1);
  return row * columns_ + column;
}

double PaintedPlane::joint(const Vec2& q, const Vec2& spacing_m, double& edge_px) const {
  double albedo = -1;
  edge_px = 1e9;
  for (int i = 0; i < 2 && plane_.tile_m > 0; ++i) {
    const double to_joint = std::abs(q[i] / plane_.tile_m - std::round(q[i] / plane_.tile_m)) * plane_.tile_m;
    edge_px = std::min(edge_px, std::abs(to_joint - kJointHalfWidth_m) / spacing_m[i]);
    if (to_joint < kJointHalfWidth_m) albedo = kJointAlbedo;
  }
  return albedo;
}

double PaintedPlane::stained_albedo(const Vec2& q) const {
  const double grain = 0.05 * stain(q * 7, seed_) + 0.03 * stain(q * 31, seed_ + 1);
  return plane_.albedo * (1 + grain);
}

PaintPatch::PaintPatch(const PaintedPlane& plane, const Vec2& q, const Mat22& footprint)
    : plane_(plane), spacing_m_(spacing(footprint, Vec2(1, 0)), spacing(footprint, Vec2(0, 1))) {
  constexpr double kReach_px = 3;  // look() goes to two pixels, and a sample is up to half a diagonal off the middle
  for (const uint16_t i : plane.decals_near_[static_cast<std::size_t>(plane.cell_of(q))]) {
    const PaintedDecal& decal = plane.decals_[i];
    if (decal.near(q, footprint, kReach_px)) near_[count_++] = {&decal, decal.footprint_of(footprint)};
  }
}

Paint PaintPatch::at(const Vec2& q, double sample_px) const {
  Paint paint;
  paint.albedo = plane_.joint(q, spacing_m_, paint.edge_px);  // negative: not known yet; paper mostly spares us
  for (std::size_t i = 0; i < count_; ++i) {
    PaintedDecal::Layer layer;
    if (!near_[i].decal->look(q, near_[i].footprint, sample_px, layer)) continue;
    if (paint.albedo < 0 && layer.paper < 1) paint.albedo = plane_.stained_albedo(q);
    paint.albedo = std::lerp(paint.albedo, layer.albedo, layer.paper);
    paint.edge_px = std::min(paint.edge_px, layer.edge_px);
  }
  if (paint.albedo < 0) paint.albedo = plane_.stained_albedo(q);
  return paint;
}

}  // namespace roomcal::tools
