#include "runtime/marker/small_markers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>

#include "runtime/marker/bilinear.h"
#include "runtime/marker/conic.h"
#include "runtime/marker/ellipse_of.h"

namespace roomcal::marker {
namespace {

constexpr int kCircle = 3;        ///< px: outside the light disc of a 15 px marker, inside its outer circle at slant 60
constexpr int kReach = 15;        ///< px: rays end here
constexpr int kMinSpeckRise = 6;  ///< grey levels: three sigma of common noise over eight neighbours
constexpr std::size_t kRays = 24;
constexpr std::size_t kSteps = 2 * kReach;
constexpr double kLargestPx = 26;              ///< minor axis; the threshold resolves larger ones
constexpr double kLongestPx = 2 * kReach + 4;  ///< major axis: few of its rays need to meet the rim

/// How far each pixel of a row rises beyond `least` above the brightest of eight on a circle around it, 0 if it does
/// not.
void rise_row(ImageView image, int y, uint8_t least, std::span<uint8_t> rise) {
  const uint8_t highest = static_cast<uint8_t>(255 - least);
  const std::ptrdiff_t stride = image.stride();
  const uint8_t* __restrict here = image.row(y);
  const uint8_t* __restrict up = here - kCircle * stride;
  const uint8_t* __restrict up2 = here - 2 * stride;
  const uint8_t* __restrict down2 = here + 2 * stride;
  const uint8_t* __restrict down = here + kCircle * stride;
  uint8_t* __restrict out = rise.data();
  const int end = image.width() - kCircle;
  for (int x = kCircle; x < end; ++x) {
    const uint8_t straight = std::max(std::max(up[x], down[x]), std::max(here[x - kCircle], here[x + kCircle]));
    const uint8_t diagonal = std::max(std::max(up2[x - 2], up2[x + 2]), std::max(down2[x - 2], down2[x + 2]));
    const uint8_t limit = static_cast<uint8_t>(std::min(std::max(straight, diagonal), highest) + least);
    out[x] = static_cast<uint8_t>(std::max(here[x], limit) - limit);
  }
}

/// Strictly above the neighbours before it in the image, not below those after it: one of a plateau remains.
bool is_peak(ImageView image, int x, int y) {
  const uint8_t value = image(x, y);
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const uint8_t other = image(x + dx, y + dy);
      const bool earlier = dy < 0 || (dy == 0 && dx < 0);
      if (other > value || (earlier && other == value)) return false;
    }
  return true;
}

/// Steepest rise of one ray, half a pixel a step. @return its distance, px; 0 if nothing rises by `least`.
double rim_distance(ImageView image, const Vec2& centre_px, const Vec2& direction, float least) {
  std::array<float, kSteps> value;
  std::size_t count = 0;
  for (; count < kSteps; ++count) {
    const Vec2 p = centre_px + 0.5 * static_cast<double>(count) * direction;
    if (p.x() < 0 || p.y() < 0 || p.x() >= image.width() - 1 || p.y() >= image.height() - 1) break;
    value[count] = bilinear(image, p.x(), p.y());
  }
  std::size_t best = 0;
  float steepest = least;
  for (std::size_t i = 5; i + 2 < count; ++i) {
    const float slope = value[i + 2] - value[i - 2];
    // Twice as steep to be preferred farther out: what lies behind the margin is not the marker's.
    if (slope < steepest) continue;
    steepest = best == 0 || i < best + 4 ? slope : 2 * slope;
    best = i;
  }
  return 0.5 * static_cast<double>(best);
}

/// Ellipse through the rim around a speck. @return false unless most rays meet it.
bool fit_rim(ImageView image, const Vec2& speck_px, const DetectorOptions& options, Candidate& candidate) {
  std::array<Vec2, kRays> store;
  std::size_t count = 0;
  for (std::size_t k = 0; k < kRays; ++k) {
    const double angle = 2 * kPi * static_cast<double>(k) / kRays;
    const Vec2 direction(std::cos(angle), std::sin(angle));
    const double distance = rim_distance(image, speck_px, direction, 0.5F * static_cast<float>(options.min_contrast));
    if (distance > 0) store[count++] = distance / 8.0 * direction;
  }
  const std::span<Vec2> points(store.data(), count);
  Conic conic = unit_circle();
  if (!fit_conic(points, 1e9, conic) || !fit_conic(points, 0.5, conic) || !fit_conic(points, 0.35, conic)) return false;
  const auto inliers = std::count_if(points.begin(), points.end(),
                                     [&conic](const Vec2& p) { return std::abs(conic_value(conic, p) - 1) < 0.3; });
  Vec2 centre;
  Mat22 S2;
  if (inliers < static_cast<int>(kRays) * 7 / 10 || !conic_ellipse(conic, centre, S2)) return false;
  const Vec2 centre_px = speck_px + 8.0 * centre;
  candidate.outer = ellipse_of(centre_px, S2 * 64.0);
  candidate.rings = 1;
  candidate.touches_border = crosses_border(image, centre_px, S2 * 64.0);
  return candidate.outer.major_px >= options.min_diameter_px && candidate.outer.major_px <= kLongestPx &&
         candidate.outer.minor_px <= kLargestPx && candidate.outer.minor_px >= 0.25 * candidate.outer.major_px &&
         (centre_px - speck_px).norm() < 1 + 0.15 * candidate.outer.minor_px;
}

/// Inside a marker that is known already. Ellipses with fewer rings hide only what is in their middle: they may be
/// none. So may large ones: a field of small markers has edges for every ellipse.
bool is_known(const Vec2& speck_px, const CandidateList& list) {
  for (const Candidate& known : list.items.first(list.count)) {
    const Ellipse& e = known.outer;
    if ((speck_px - e.centre_px).squaredNorm() > e.major_px * e.major_px / 4) continue;
    const double reach = e.major_px > 2 * kLongestPx ? 0.0025 : known.rings >= 3 ? 1.0 : 0.25;
    if (radius2_in(e, speck_px) < reach) return true;
  }
  return false;
}

/// Does it get light again beyond the dark, in seven of eight directions? Most peaks of noise end here. As light as
/// the speck; or, because light may change from side to side and a slanted sheet's margin is narrower than its blur,
/// well above the darkest before it: by more than noise spans along a ray.
bool has_rim(ImageView image, int x, int y, int rise, int noise_rise) {
  constexpr std::array<std::array<int, 2>, 8> kCompass = {
      {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
  const int wanted = image(x, y) - 3 * rise / 5;
  const int step = std::max(rise / 2, 3 * noise_rise / 2);
  int met = 0;
  for (std::size_t k = 0; k < kCompass.size(); ++k) {
    if (met + static_cast<int>(kCompass.size() - k) < 7) return false;
    bool light = false;
    int darkest = 255;
    const bool diagonal = k % 2 != 0;
    for (int i = diagonal ? 2 : kCircle; i <= (diagonal ? 10 : 14) && !light; ++i) {
      const int px = x + i * kCompass[k][0];
      const int py = y + i * kCompass[k][1];
      if (px < 0 || py < 0 || px >= image.width() || py >= image.height()) break;
      const int value = image(px, py);
      darkest = std::min(darkest, value);
      light = value >= std::min(wanted, darkest + step);
    }
    met += light ? 1 : 0;
  }
  return met >= 7;
}

void look_at(ImageView image, int x, int y, int rise, int noise_rise, const DetectorOptions& options,
             CandidateList& list) {
  const Vec2 speck_px(x, y);
  if (!is_peak(image, x, y) || !has_rim(image, x, y, rise, noise_rise) || is_known(speck_px, list)) return;
  ++list.probed;
  Candidate candidate;
  if (fit_rim(image, speck_px, options, candidate)) add_candidate(candidate, list);
}

}  // namespace

std::size_t small_markers_bytes(int width_px) { return (static_cast<std::size_t>(width_px) + 7) / 8 * 8; }

Status find_small_markers(ImageView image, const DetectorOptions& options, int min_rise, Arena& arena,
                          CandidateList& list) {
  const Arena::Scope scope(arena);
  const std::span<uint8_t> rise = arena.allocate<uint8_t>(small_markers_bytes(image.width()));
  if (rise.empty()) return out_of_arena("marker candidates: give the detector detector_scratch_bytes()");
  const uint8_t least = static_cast<uint8_t>(std::clamp(min_rise, kMinSpeckRise, 255));
  for (int y = kCircle; y < image.height() - kCircle; ++y) {
    rise_row(image, y, least, rise);
    for (int x = 0; x < image.width(); x += 8) {
      uint64_t eight = 0;
      std::memcpy(&eight, rise.data() + x, sizeof eight);
      if (eight == 0) continue;
      for (int i = x; i < std::min(x + 8, image.width()); ++i)
        if (const int height = rise[static_cast<std::size_t>(i)]; height > 0)
          look_at(image, i, y, height + least, least, options, list);
    }
  }
  return ok_status();
}

}  // namespace roomcal::marker
