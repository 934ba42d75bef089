#include "runtime/marker/ring_probe.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "runtime/base/fixed_vector.h"
#include "runtime/marker/bilinear.h"
#include "runtime/marker/blob_shape.h"
#include "runtime/marker/conic.h"
#include "runtime/marker/ellipse_of.h"

namespace roomcal::marker {
namespace {

constexpr int kRays = 36;
constexpr int kMaxSteps = 128;
constexpr std::size_t kRayCount = kRays;
constexpr std::size_t kStepCount = kMaxSteps;

/// Every third ray, for a first look at a blob that has nothing but its own shape to speak for it.
constexpr int kFirstLookStride = 3;
/// Distance between two edges that a ray must span to resolve them, px.
constexpr double kResolvedPx = 1.5;
/// Part of the rays that resolve an edge which must show it, and of all rays that must resolve it.
constexpr double kSupport = 0.55;
constexpr double kResolvedPart = 0.28;

/// Rays begin here, in multiples of the blob: its own edge must be on them, its inside need not.
constexpr double kNearest = 0.6;

using RayMask = uint64_t;
static_assert(kRays <= 64);

/// Directions of the rays, once.
struct Directions {
  std::array<Vec2, kRayCount> u;
  Directions() {
    for (std::size_t k = 0; k < kRayCount; ++k) {
      const double angle = 2 * kPi * static_cast<double>(k) / kRays;
      u[k] = Vec2(std::cos(angle), std::sin(angle));
    }
  }
};

/// Image along the rays: value[k][i] at centre + i * step * S * u_k, -1 outside the image.
struct Polar {
  std::array<std::array<float, kStepCount>, kRayCount> value;
  std::array<RayMask, kStepCount> visible;  ///< rays inside the image at this step
  std::array<double, kRayCount> length_px;  ///< |S u_k|
  int stride = 1;                           ///< rays 0, stride, 2 * stride, .. are sampled
  int steps = 0;
  double step = 0;  ///< in multiples of the blob's ellipse
  Mat22 S = Mat22::Identity();
  Vec2 centre_px = Vec2::Zero();

  int ray_total() const { return kRays / stride; }
};

/// Rays that vote for an edge, by step: rising is dark to light, going outwards.
struct Votes {
  std::array<RayMask, kStepCount> rising{};
  std::array<RayMask, kStepCount> falling{};
};

/// An edge of the marker: on all rays at step `at`.
struct Edge {
  int at = -1;
  bool rising = false;
  RayMask resolved = 0;  ///< rays that should show it
};

const Directions& directions() {
  static const Directions all;
  return all;
}

/// Symmetric square root of S^2: (S^2 + sqrt(det) I) / sqrt(trace + 2 sqrt(det)).
Mat22 shape_root(const Blob& blob) {
  const double root_det = std::sqrt(std::max(blob.sxx * blob.syy - blob.sxy * blob.sxy, 0.0));
  const double scale = 1.0 / std::sqrt(blob.sxx + blob.syy + 2 * root_det);
  Mat22 S;
  S << blob.sxx + root_det, blob.sxy, blob.sxy, blob.syy + root_det;
  return S * scale;
}

/// How far outside a blob the marker's outer circle may lie. A quarter of the outer radius is the smallest light disc
/// in use; each ring that the blob already contains takes its share away.
double reach(const Blob& blob) {
  if (blob.dark_depth == 0) return 5.4;
  if (blob.depth == 1) return 1.6;
  return blob.dark_depth == 1 ? 4.2 : blob.dark_depth == 2 ? 2.6 : 1.9;
}

/// Samples steps from `from` (in multiples of the blob) to `range`; nearer ones read as invisible.
void sample(ImageView image, const Blob& blob, double from, double range, int stride, Polar& polar) {
  const double pixels = range * half_major(blob);
  polar.stride = stride;
  polar.steps = std::clamp(static_cast<int>(pixels / 0.6) + 1, 12, kMaxSteps);
  polar.step = range / (polar.steps - 1);
  polar.S = shape_root(blob);
  polar.centre_px = Vec2(blob.x, blob.y);
  polar.visible.fill(0);
  const int first = std::min(static_cast<int>(from / polar.step), polar.steps - 1);
  for (auto& ray : polar.value) std::fill_n(ray.begin(), first, -1.0F);
  const float x_limit = static_cast<float>(image.width()) - 1.001F;
  const float y_limit = static_cast<float>(image.height()) - 1.001F;
  RayMask whole_rays = 0;  // inside the image at both ends, so inside all along
  for (std::size_t k = 0; k < kRayCount; k += static_cast<std::size_t>(stride)) {
    const Vec2 direction = polar.S * directions().u[k];
    polar.length_px[k] = direction.norm();
    const float x0 = static_cast<float>(polar.centre_px.x()), y0 = static_cast<float>(polar.centre_px.y());
    const float dx = static_cast<float>(polar.step * direction.x()),
                dy = static_cast<float>(polar.step * direction.y());
    const auto x_at = [x0, dx](int i) { return x0 + static_cast<float>(i) * dx; };
    const auto y_at = [y0, dy](int i) { return y0 + static_cast<float>(i) * dy; };
    const auto inside = [&](int i) { return x_at(i) >= 0 && y_at(i) >= 0 && x_at(i) < x_limit && y_at(i) < y_limit; };
    const bool whole = inside(first) && inside(polar.steps - 1);
    if (whole) whole_rays |= RayMask{1} << k;
    for (int i = first; i < polar.steps; ++i) {
      const std::size_t at = static_cast<std::size_t>(i);
      const bool here = whole || inside(i);
      polar.value[k][at] = here ? bilinear(image, x_at(i), y_at(i)) : -1.0F;
      if (!whole && here) polar.visible[at] |= RayMask{1} << k;
    }
  }
  for (int i = first; i < polar.steps; ++i) polar.visible[static_cast<std::size_t>(i)] |= whole_rays;
}

/// Change across step i of one ray; 0 at its ends and at the image's border.
float slope(const Polar& polar, std::size_t k, int i) {
  if (i < 1 || i + 1 >= polar.steps) return 0;
  const float before = polar.value[k][static_cast<std::size_t>(i - 1)];
  const float after = polar.value[k][static_cast<std::size_t>(i + 1)];
  return before < 0 || after < 0 ? 0 : after - before;
}

Votes vote(const Polar& polar, int first, float least) {
  Votes votes;
  for (std::size_t k = 0; k < kRayCount; k += static_cast<std::size_t>(polar.stride)) {
    const RayMask ray = RayMask{1} << k;
    float previous = slope(polar, k, first - 1);
    float here = slope(polar, k, first);
    for (int i = first; i < polar.steps - 1; ++i) {
      const float next = slope(polar, k, i + 1);
      const std::size_t at = static_cast<std::size_t>(i);
      if (here >= least && here >= previous && here > next) votes.rising[at] |= ray;
      if (-here >= least && -here >= -previous && -here > -next) votes.falling[at] |= ray;
      previous = here;
      here = next;
    }
  }
  return votes;
}

/// Rays that vote near a step: the ellipses of a marker share their centre only nearly, and less so the farther apart.
RayMask voters(const std::array<RayMask, kStepCount>& votes, const Polar& polar, int i) {
  const int half = 1 + static_cast<int>(0.03 * i);
  RayMask all = 0;
  for (int j = std::max(i - half, 0); j <= std::min(i + half, polar.steps - 1); ++j)
    all |= votes[static_cast<std::size_t>(j)];
  return all;
}

/// Visible rays long enough to tell an edge at step i from the one at step `from`.
RayMask resolving(const Polar& polar, int from, int i) {
  RayMask rays = 0;
  for (std::size_t k = 0; k < kRayCount; k += static_cast<std::size_t>(polar.stride))
    if ((i - from) * polar.step * polar.length_px[k] >= kResolvedPx) rays |= RayMask{1} << k;
  return rays & polar.visible[static_cast<std::size_t>(i)];
}

bool supported(RayMask for_it, RayMask resolved, const Polar& polar) {
  const int able = std::popcount(resolved);
  return able >= kResolvedPart * polar.ray_total() && std::popcount(for_it & resolved) >= kSupport * able;
}

/// First supported edge of the wanted sense beyond `from`, at its peak; at = -1 if there is none up to `limit`.
Edge next_edge(const Votes& votes, const Polar& polar, int from, int limit, bool rising) {
  const auto& lists = rising ? votes.rising : votes.falling;
  for (int i = from + 1; i <= std::min(limit, polar.steps - 2); ++i) {
    const RayMask resolved = resolving(polar, from, i);
    int most = std::popcount(voters(lists, polar, i) & resolved);
    if (!supported(voters(lists, polar, i), resolved, polar)) continue;
    int best = i;
    const int end = i + 2 + static_cast<int>(0.06 * i);
    for (int j = i + 1; j <= std::min(end, polar.steps - 2); ++j) {
      const int count = std::popcount(voters(lists, polar, j) & resolved);
      if (count > most) {
        best = j;
        most = count;
      }
    }
    return {best, rising, resolved};
  }
  return {-1, rising, 0};
}

/// Mean over the visible rays.
float mean_at(const Polar& polar, int i) {
  float sum = 0;
  int count = 0;
  for (std::size_t k = 0; k < kRayCount; k += static_cast<std::size_t>(polar.stride)) {
    const float v = polar.value[k][static_cast<std::size_t>(i)];
    if (v < 0) continue;
    sum += v;
    ++count;
  }
  return count == 0 ? 0 : sum / static_cast<float>(count);
}

/// Contrast between ink and sheet around the blob's edge.
float edge_contrast(const Polar& polar) {
  const int one = static_cast<int>(std::lround(1.0 / polar.step));
  float low = 255;
  float high = 0;
  for (int i = std::max(one * 3 / 4, 0); i <= std::min(one + std::max(2, one / 4), polar.steps - 1); ++i) {
    const float mean = mean_at(polar, i);
    low = std::min(low, mean);
    high = std::max(high, mean);
  }
  return high - low;
}

/// A small dark blob is a marker only if its middle is lighter than what surrounds that: plain dots are not.
bool light_middle(const Polar& polar, float contrast) {
  const int one = static_cast<int>(std::lround(1.0 / polar.step));
  float peak = 0;
  float drop = 0;
  for (int i = 0; i <= one; ++i) {
    const float mean = mean_at(polar, i);
    peak = std::max(peak, mean);
    drop = std::max(drop, peak - mean);
  }
  return drop >= std::max(2.5F, 0.03F * contrast);
}

/// Point of each ray where the edge near step `at` is steepest, in multiples of the blob's ellipse.
int edge_points(const Polar& polar, int at, float least, std::array<Vec2, kRayCount>& points) {
  int count = 0;
  const int half = 1 + static_cast<int>(0.07 * at);
  for (std::size_t k = 0; k < kRayCount; ++k) {
    int best = at;
    for (int i = at - half; i <= at + half; ++i)
      if (slope(polar, k, i) > slope(polar, k, best)) best = i;
    const float here = slope(polar, k, best);
    if (here < least) continue;
    const float before = slope(polar, k, best - 1);
    const float after = slope(polar, k, best + 1);
    const float bend = before - 2 * here + after;
    const double shift = bend < 0 ? std::clamp(static_cast<double>(0.5F * (before - after) / bend), -0.5, 0.5) : 0.0;
    points[static_cast<std::size_t>(count++)] = (best + shift) * polar.step * directions().u[k];
  }
  return count;
}

using EdgeList = FixedVector<Edge, 12>;

/// Rising edges of the alternation that goes outwards from the blob's own edge, that one included if it rises.
EdgeList rising_edges(const Votes& votes, const Polar& polar, const Blob& blob) {
  const int one = static_cast<int>(std::lround(1.0 / polar.step));
  EdgeList found;
  Edge edge{one, blob.dark, polar.visible[static_cast<std::size_t>(one)]};
  if (edge.rising) static_cast<void>(found.push_back(edge));
  while (!found.full()) {
    // Dark rings end within 1.6 times their inner radius, light ones within 1.4, in the marker banks in use.
    const double widest = edge.rising ? 0.5 : 0.75;
    const int limit = edge.at + std::max(3, static_cast<int>(widest * edge.at));
    edge = next_edge(votes, polar, edge.at, limit, !edge.rising);
    if (edge.at < 0) break;
    if (edge.rising) static_cast<void>(found.push_back(edge));
  }
  return found;
}

/// Ellipse through one rising edge. @return false unless the rays that resolve it lie on one.
bool fit_edge(const Polar& polar, const Edge& edge, float least, Vec2& centre_px, Mat22& S2) {
  std::array<Vec2, kRayCount> store;
  const std::span<Vec2> points(store.data(), static_cast<std::size_t>(edge_points(polar, edge.at, least, store)));
  const double scale = edge.at * polar.step;
  for (Vec2& point : points) point /= scale;
  Conic conic = unit_circle();
  if (!fit_conic(points, 0.3, conic) || !fit_conic(points, 0.12, conic)) return false;
  const double near = 0.07 + 1.0 / edge.at;
  const auto inliers = std::count_if(points.begin(), points.end(), [&conic, near](const Vec2& point) {
    return std::abs(conic_value(conic, point) - 1) < near;
  });
  Vec2 centre;
  Mat22 shape;
  if (static_cast<double>(inliers) < kSupport * std::popcount(edge.resolved)) return false;
  if (!conic_ellipse(conic, centre, shape) || centre.norm() > 0.3) return false;
  centre_px = polar.centre_px + polar.S * (centre * scale);
  S2 = polar.S * shape * polar.S * (scale * scale);
  return true;
}

/// A light blob without a concentric dark one around it: is there a thin dark ring at all?
bool first_look(ImageView image, const Blob& blob, const DetectorOptions& options) {
  Polar polar;
  sample(image, blob, kNearest, 2.0, kFirstLookStride, polar);
  const float contrast = edge_contrast(polar);
  if (contrast < 0.3F * static_cast<float>(options.min_contrast)) return false;
  const Votes votes = vote(polar, std::max(2, static_cast<int>(0.7 / polar.step)), std::max(3.0F, 0.1F * contrast));
  const int one = static_cast<int>(std::lround(1.0 / polar.step));
  return next_edge(votes, polar, one, polar.steps, true).at > 0;
}

}  // namespace

bool probe_rings(ImageView image, const Blob& blob, const DetectorOptions& options, Candidate& found) {
  if (blob.dark_depth == 0 && !first_look(image, blob, options)) return false;
  Polar polar;
  const bool alone = blob.dark && blob.inner < 0;  // its middle has to be looked at, too
  sample(image, blob, alone ? 0.0 : kNearest, reach(blob), 1, polar);
  const float contrast = edge_contrast(polar);
  if (contrast < 0.3F * static_cast<float>(options.min_contrast)) return false;
  const bool whole = polar.visible[static_cast<std::size_t>(std::lround(1.0 / polar.step))] == polar.visible[0];
  const bool unresolved = alone && whole;
  if (unresolved && !light_middle(polar, contrast)) return false;

  const float least = std::max(3.0F, 0.1F * contrast);
  const Votes votes = vote(polar, std::max(2, static_cast<int>(0.7 / polar.step)), least);
  EdgeList edges = rising_edges(votes, polar, blob);
  Vec2 centre_px;
  Mat22 S2;
  const auto ring_count = [&] { return blob.dark_depth + static_cast<int>(edges.size()) - (blob.dark ? 1 : 0); };
  while (edges.size() > 1 && ring_count() > options.max_rings) edges.pop_back();
  while (!edges.empty() && !fit_edge(polar, edges.back(), least, centre_px, S2)) edges.pop_back();
  if (edges.empty()) return false;
  found.outer = ellipse_of(centre_px, S2);
  found.rings = ring_count();
  found.touches_border = crosses_border(image, centre_px, S2);
  return found.outer.major_px >= options.min_diameter_px && found.outer.minor_px >= 0.15 * found.outer.major_px;
}

}  // namespace roomcal::marker
