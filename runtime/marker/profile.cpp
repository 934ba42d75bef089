#include "runtime/marker/profile.h"

#include <algorithm>
#include <cmath>

namespace roomcal::marker {
namespace {

constexpr int kRays = PolarGrid::kRays;
constexpr int kMaxSamples = PolarGrid::kMaxSamples;
using Curve = std::array<float, kMaxSamples>;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Samples of a ray that lie inside the image, up to `limit`.
int inside_samples(const PolarGrid& grid, int ray, int limit) {
  int count = 0;
  while (count < limit && grid.level[at(ray)][at(count)] >= 0) ++count;
  return count;
}

// Rays normalized to mean 0, deviation 1 over the disc: every ray of a marker then shows the same curve, whatever
// the light on it.
struct NormalizedRays {
  std::array<Curve, kRays> level;
  std::array<bool, kRays> usable{};
  std::array<float, kRays> mean{}, deviation{};
  int disc_samples = 0;
};

void normalize_rays(const PolarGrid& grid, NormalizedRays& rays) {
  rays.disc_samples = std::min(grid.samples, static_cast<int>(std::ceil(grid.sample(1.08))));
  for (int ray = 0; ray < kRays; ++ray) {
    const Curve& level = grid.level[at(ray)];
    const int inside = inside_samples(grid, ray, grid.samples);
    if (inside < rays.disc_samples) continue;
    float sum = 0, square = 0;
    for (int j = 0; j < rays.disc_samples; ++j) {
      sum += level[at(j)];
      square += level[at(j)] * level[at(j)];
    }
    const float n = static_cast<float>(rays.disc_samples);
    const float mean = sum / n;
    const float variance = square / n - mean * mean;
    if (variance < 1.0F) continue;
    const float scale = 1.0F / std::sqrt(variance);
    for (int j = 0; j < grid.samples; ++j) {
      rays.level[at(ray)][at(j)] = j < inside ? (level[at(j)] - mean) * scale : 0.0F;
    }
    rays.usable[at(ray)] = true;
    rays.mean[at(ray)] = mean;
    rays.deviation[at(ray)] = 1.0F / scale;
  }
}

// Rays within 45 degrees (in the circle's own frame) of the major axis for a slanted marker, all for an upright one.
bool is_sharp_ray(const PolarGrid& grid, int ray) {
  if (grid.A.col(1).norm() > 0.75 * grid.A.col(0).norm()) return true;
  return std::fabs(grid.direction[at(ray)].x()) > 0.7;
}

float correlation(const Curve& a, const Curve& mean, int n) {
  float ab = 0, aa = 0, bb = 0;
  for (int j = 0; j < n; ++j) {
    ab += a[at(j)] * mean[at(j)];
    aa += a[at(j)] * a[at(j)];
    bb += mean[at(j)] * mean[at(j)];
  }
  return ab / std::sqrt(aa * bb + 1e-6F);
}

struct MeanProfile {
  Curve level{};
  double paper = 0, ink = 0;
  double agreement = 0, visible = 0;
  int used = 0;
};

// Mean of the sharp rays, then once more without those that look different (occluders, shadow edges).
void average_rays(const PolarGrid& grid, const NormalizedRays& rays, MeanProfile& profile) {
  constexpr float kLike = 0.6F;
  std::array<bool, kRays> take = rays.usable;
  int agreeing = 0, usable = 0;
  for (int pass = 0; pass < 2; ++pass) {
    Curve sum{};
    profile.used = 0;
    float mean = 0, deviation = 0;
    for (int ray = 0; ray < kRays; ++ray) {
      if (!take[at(ray)] || !is_sharp_ray(grid, ray)) continue;
      for (int j = 0; j < grid.samples; ++j) sum[at(j)] += rays.level[at(ray)][at(j)];
      mean += rays.mean[at(ray)];
      deviation += rays.deviation[at(ray)];
      ++profile.used;
    }
    if (profile.used == 0) return;
    const float n = static_cast<float>(profile.used);
    for (int j = 0; j < grid.samples; ++j) profile.level[at(j)] = sum[at(j)] / n;
    const auto [low, high] = std::minmax_element(profile.level.begin(), profile.level.begin() + rays.disc_samples);
    profile.paper = static_cast<double>((mean + *high * deviation) / n);
    profile.ink = static_cast<double>((mean + *low * deviation) / n);
    agreeing = usable = 0;
    for (int ray = 0; ray < kRays; ++ray) {
      if (!rays.usable[at(ray)]) continue;
      const bool like = correlation(rays.level[at(ray)], profile.level, rays.disc_samples) > kLike;
      take[at(ray)] = like;
      if (!is_sharp_ray(grid, ray)) continue;
      ++usable;
      agreeing += like ? 1 : 0;
    }
  }
  const auto visible = std::count(rays.usable.begin(), rays.usable.end(), true);
  profile.visible = static_cast<double>(visible) / kRays;
  profile.agreement = usable > 0 ? static_cast<double>(agreeing) / usable : 0;
}

// Position of the steepest rise (sign > 0) or fall between two samples, in samples.
double steepest(const Curve& level, int from, int to, float sign, float& slope) {
  int best = from;
  slope = -1e9F;
  for (int j = from; j < to; ++j) {
    const float rise = sign * (level[at(j + 1)] - level[at(j)]);
    if (rise > slope) {
      slope = rise;
      best = j;
    }
  }
  double shift = 0;
  if (best > from && best + 1 < to) {
    const auto left = static_cast<double>(sign * (level[at(best)] - level[at(best - 1)]));
    const auto right = static_cast<double>(sign * (level[at(best + 2)] - level[at(best + 1)]));
    const double curvature = left - 2 * static_cast<double>(slope) + right;
    if (curvature < -1e-9) shift = std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5);
  }
  return best + 0.5 + shift;
}

// Local extrema going inwards from the outer edge; neighbours differ by `swing` at least. Starts with the paper
// outside, so even entries are light.
struct Extrema {
  std::array<int, 2 * kMaxEdges> sample{};
  int count = 0;
};

Extrema find_extrema(const Curve& level, int first, float swing) {
  Extrema extrema;
  bool want_dark = true;
  int best = first;
  for (int j = first; j >= 0; --j) {
    const float sign = want_dark ? 1.0F : -1.0F;
    // `best` is the extremum being followed: the lightest so far when waiting for dark, and the other way round.
    if (sign * (level[at(j)] - level[at(best)]) > 0) {
      best = j;
    } else if (sign * (level[at(best)] - level[at(j)]) > swing && extrema.count < 2 * kMaxEdges) {
      extrema.sample[at(extrema.count++)] = best;
      want_dark = !want_dark;
      best = j;
    }
  }
  if (extrema.count < 2 * kMaxEdges) extrema.sample[at(extrema.count++)] = best;
  return extrema;
}

// A dark ring around the supposed outer circle means that the candidate is an inner ring.
double find_next_outer(const PolarGrid& grid, const NormalizedRays& rays, const MeanProfile& profile) {
  const int first = std::min(grid.samples - 1, static_cast<int>(grid.sample(1.06)) + 1);
  int darkest = first;
  for (int j = first; j < grid.samples; ++j) {
    if (profile.level[at(j)] < profile.level[at(darkest)]) darkest = j;
  }
  const auto [low, high] = std::minmax_element(profile.level.begin(), profile.level.begin() + rays.disc_samples);
  const float middle = (*low + *high) / 2;
  if (profile.level[at(darkest)] > middle - 0.1F * (*high - *low)) return 0;
  int dark = 0, usable = 0;
  for (int ray = 0; ray < kRays; ++ray) {
    if (!rays.usable[at(ray)]) continue;
    ++usable;
    dark += rays.level[at(ray)][at(darkest)] < middle ? 1 : 0;
  }
  if (dark < 0.8 * usable || darkest + 2 >= grid.samples) return 0;
  float slope = 0;
  const int last = std::min(grid.samples - 1, darkest + static_cast<int>(0.35 / grid.spacing));
  const double edge = steepest(profile.level, darkest, last, 1.0F, slope);
  return slope > 0.1F * (*high - *low) ? grid.radius(edge) : 0;
}

}  // namespace

RadialProfile read_profile(const PolarGrid& grid, double swing) {
  RadialProfile result;
  NormalizedRays rays;
  normalize_rays(grid, rays);
  MeanProfile profile;
  average_rays(grid, rays, profile);
  result.visible = profile.visible;
  result.agreement = profile.agreement;
  if (profile.used < kRays / 8) return result;
  result.paper = profile.paper;
  result.ink = profile.ink;
  result.next_outer_radius = find_next_outer(grid, rays, profile);

  const auto [low, high] = std::minmax_element(profile.level.begin(), profile.level.begin() + rays.disc_samples);
  const float range = *high - *low;
  const int outside = std::min(rays.disc_samples - 1, static_cast<int>(std::ceil(grid.sample(1.06))));
  const Extrema extrema = find_extrema(profile.level, outside, static_cast<float>(swing) * range);
  const int rings = (extrema.count - 1) / 2;
  if (rings < 1 || rings > kMaxRings) return result;
  for (int edge = 0; edge < 2 * rings; ++edge) {
    float slope = 0;
    const int outer = extrema.sample[at(edge)], inner = extrema.sample[at(edge + 1)];
    const double position = steepest(profile.level, inner, outer, edge % 2 == 0 ? 1.0F : -1.0F, slope);
    result.radius[at(edge)] = grid.radius(position);
    if (edge > 0) continue;
    // A blurred step of height h rises at most by h / (sqrt(2 pi) sigma) per unit of length.
    const double slope_per_px = static_cast<double>(slope) / (grid.spacing * grid.A.col(0).norm());
    result.blur_px = std::clamp(static_cast<double>(range) / (2.5066 * slope_per_px), 0.7, 4.0);
  }
  const double outer_radius = result.radius[0];
  for (int edge = 0; edge < 2 * rings; ++edge) result.radius[at(edge)] /= outer_radius;
  result.rings = rings;
  return result;
}

}  // namespace roomcal::marker
