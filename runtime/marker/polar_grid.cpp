#include "runtime/marker/polar_grid.h"

#include <algorithm>
#include <cmath>

#include "runtime/marker/bilinear.h"

namespace roomcal::marker {
namespace {

constexpr int kRays = PolarGrid::kRays;
constexpr int kMaxSamples = PolarGrid::kMaxSamples;
using Curve = std::array<float, kMaxSamples>;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Rays from half a step onwards, by rotation: sines and cosines of all angles would cost as much as the samples.
void fill_directions(std::array<Vec2, kRays>& direction) {
  const double step = 2 * kPi / kRays;
  const Vec2 turn{std::cos(step), std::sin(step)};
  direction[0] = {std::cos(step / 2), std::sin(step / 2)};
  for (std::size_t ray = 1; ray < direction.size(); ++ray) {
    const Vec2& last = direction[ray - 1];
    direction[ray] = {last.x() * turn.x() - last.y() * turn.y(), last.x() * turn.y() + last.y() * turn.x()};
  }
}

// One ray in pixels: position(j) = centre + (start + j step) / (1 + bend (j + 1/2)); `bend` is 0 without a shift.
struct PixelRay {
  float x_centre, y_centre, x_start, y_start, x_step, y_step, bend;

  float divisor(float j) const { return bend == 0 ? 1.0F : 1.0F / (1.0F + bend * (j + 0.5F)); }
};

PixelRay pixel_ray(const PolarGrid& grid, int ray) {
  const Vec2 u = grid.direction[at(ray)];
  Vec2 step = u;
  if (const double shift2 = grid.shift.squaredNorm(); shift2 > 0) {
    const Vec2 along = grid.shift * (grid.shift.dot(u) / shift2);
    step = along + std::sqrt(1 - shift2) * (u - along);
  }
  const Vec2 step_px = grid.A * step * grid.spacing;
  const Vec2 start_px = grid.A * grid.shift + 0.5 * step_px;
  const auto narrow = [](double value) { return static_cast<float>(value); };
  return {narrow(grid.centre_px.x()),
          narrow(grid.centre_px.y()),
          narrow(start_px.x()),
          narrow(start_px.y()),
          narrow(step_px.x()),
          narrow(step_px.y()),
          narrow(grid.shift.dot(u) * grid.spacing)};
}

// Samples [first, last] of a ray; one that is inside the image at both ends is inside all along.
void sample_ray(ImageView image, const PixelRay& ray, int first, int last, Curve& level) {
  const float right = static_cast<float>(image.width() - 1), bottom = static_cast<float>(image.height() - 1);
  const auto x_at = [&ray](float j) { return ray.x_centre + (ray.x_start + j * ray.x_step) * ray.divisor(j); };
  const auto y_at = [&ray](float j) { return ray.y_centre + (ray.y_start + j * ray.y_step) * ray.divisor(j); };
  const auto is_inside = [&](int j) {
    const float x = x_at(static_cast<float>(j)), y = y_at(static_cast<float>(j));
    return x >= 0 && y >= 0 && x < right && y < bottom;
  };
  const bool whole = is_inside(first) && is_inside(last);
  for (int j = first; j <= last; ++j) {
    if (!whole && !is_inside(j)) {
      level[at(j)] = -1;
      continue;
    }
    level[at(j)] = bilinear(image, x_at(static_cast<float>(j)), y_at(static_cast<float>(j)));
  }
}

// Variance of the mean over the rays: rings that all rays show at one radius stand out, others average away.
double ring_swing(const PolarGrid& grid, int first, int last) {
  double sum = 0, square = 0;
  for (int j = first; j <= last; ++j) {
    double mean = 0;
    for (const Curve& level : grid.level) mean += static_cast<double>(std::fmax(level[at(j)], 0.0F));
    mean /= kRays;
    sum += mean;
    square += mean * mean;
  }
  const double n = last - first + 1;
  return square / n - sum * sum / (n * n);
}

}  // namespace

void place_grid(const Ellipse& ellipse, const Vec2& shift, PolarGrid& grid) {
  const double cosine = std::cos(ellipse.angle_rad), sine = std::sin(ellipse.angle_rad);
  grid.centre_px = ellipse.centre_px;
  grid.shift = shift;
  grid.A.col(0) = Vec2{cosine, sine} * (ellipse.major_px / 2);
  grid.A.col(1) = Vec2{-sine, cosine} * (ellipse.minor_px / 2);
  fill_directions(grid.direction);
  // Two thirds of a pixel along the major axis while the buffer lasts; a small marker needs a few samples a ring all
  // the same.
  const double wanted = 1.5 * PolarGrid::kReach * grid.A.col(0).norm();
  grid.samples = std::clamp(static_cast<int>(wanted), 42, kMaxSamples);
  grid.spacing = PolarGrid::kReach / grid.samples;
}

void sample_rays(ImageView image, double from, double to, PolarGrid& grid) {
  const int first = std::max(0, static_cast<int>(grid.sample(from)));
  const int last = std::min(grid.samples - 1, static_cast<int>(std::ceil(grid.sample(to))));
  for (int ray = 0; ray < kRays; ++ray) {
    sample_ray(image, pixel_ray(grid, ray), first, last, grid.level[at(ray)]);
  }
}

Vec2 find_centre_shift(ImageView image, const Ellipse& ellipse, PolarGrid& grid) {
  constexpr double kLargest = 0.5;  // a marker's radius at half its distance
  Vec2 best = Vec2::Zero();
  double most = 0;
  const auto look = [&](const Vec2& shift) {
    if (shift.norm() > kLargest) return;
    place_grid(ellipse, shift, grid);
    sample_rays(image, 0.15, 1, grid);
    const double swing = ring_swing(grid, static_cast<int>(grid.sample(0.2)), static_cast<int>(grid.sample(0.95)));
    if (swing <= most) return;
    most = swing;
    best = shift;
  };
  // Rings are 0.15 wide: a step of half that cannot miss them, and two more bring the start near.
  for (const double step : {0.08, 0.03, 0.01}) {
    const Vec2 middle = best;
    const int reach = step > 0.05 ? static_cast<int>(kLargest / step) : 1;
    for (int i = -reach; i <= reach; ++i) {
      for (int j = -reach; j <= reach; ++j) look(middle + step * Vec2(i, j));
    }
  }
  return best;
}

}  // namespace roomcal::marker
