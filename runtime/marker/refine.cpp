#include "runtime/marker/refine.h"

#include <algorithm>
#include <cmath>

#include "runtime/marker/profile.h"
#include "runtime/marker/reduce_marker.h"
#include "runtime/marker/ring_pixels.h"
#include "runtime/marker/verify.h"

namespace roomcal::marker {
namespace {

// Sheets are white up to about 1.2 outer radii; a little less keeps blur of what lies beyond out.
constexpr double kFitReach = 1.15;
constexpr int kThinnedPixels = 384;
constexpr double kSettledChange = 0.03;   // of the size; the fit to the pixels takes it from there
constexpr double kUnmovedChange = 0.015;  // of the size; the grid may stay where it is
constexpr int kMaxReseeds = 2;            // an inner ring of three may have two around it

constexpr Status refuse(const char* why) { return {StatusCode::kNotFound, why}; }
Status out_of_scratch() { return out_of_arena("marker fit: give detect() its detector_scratch_bytes()"); }

struct Start {
  Ellipse outer;
  Vec2 shift = Vec2::Zero();  // see PolarGrid
  RadialProfile profile;
};

// How far an ellipse moved, as a share of its size.
double change_of(const Ellipse& before, const Ellipse& after) {
  const double moved = 2 * (after.centre_px - before.centre_px).norm() / before.minor_px;
  return std::max(
      {moved, std::abs(after.major_px / before.major_px - 1), std::abs(after.minor_px / before.minor_px - 1)});
}

// Wide window first; the second look samples in the better frame, where the first has moved it enough to matter.
Status snap(ImageView image, PolarGrid& grid, Ellipse& ellipse) {
  double support = 0;
  for (const double window : {0.2, 0.12}) {
    // find_edge() looks a difference's reach beyond its window: 0.2 covers both at every size.
    const double from = 1 - window - 0.2, to = 1 + window + 0.2;
    place_grid(ellipse, Vec2::Zero(), grid);
    sample_rays(image, from, to, grid);
    const Ellipse before = ellipse;
    ROOMCAL_TRY(snap_to_outer_edge(grid, window, ellipse, support));
    const double change = change_of(before, ellipse);
    if (support > 0.9 && change < kUnmovedChange) {
      sample_rays(image, 0, from, grid);
      sample_rays(image, to, PolarGrid::kReach, grid);
      return ok_status();
    }
    if (support > 0.9 && change < kSettledChange) break;
  }
  if (support < 0.5) return refuse("no closed dark-to-light edge");
  place_grid(ellipse, Vec2::Zero(), grid);
  sample_rays(image, 0, PolarGrid::kReach, grid);
  return ok_status();
}

// Large swings first: small ones only where nothing else shows three rings, so that the ringing of sharpened images
// adds none.
RadialProfile read_rings(const PolarGrid& grid, const DetectorOptions& options) {
  RadialProfile profile;
  for (const double swing : {0.25, 0.1, 0.04, 0.02}) {
    profile = read_profile(grid, swing);
    if (profile.rings >= options.min_rings) break;
  }
  return profile;
}

// Under a few pixels a ring the mean profile no longer swings, because the ellipse is only known to a few tenths of a
// pixel. The fit can still find the rings from an even spacing; its verification decides.
void suppose_rings(Start& start) {
  constexpr double kLargest_px = 26;  // minor axis: rings of two pixels
  if (start.outer.minor_px > kLargest_px && start.outer.major_px > 1.5 * kLargest_px) return;
  start.profile.rings = 3;
  start.profile.radius = {1, 0.85, 0.70, 0.55, 0.40, 0.25};
  start.profile.blur_px = std::min(start.profile.blur_px, 0.9);
}

// A marker that fills much of the view has its circles' centre far from the ellipse's: rays from there disagree.
void allow_for_perspective(ImageView image, const DetectorOptions& options, PolarGrid& grid, Start& start) {
  constexpr double kSmallest_px = 100;  // minor axis; under it the shift is less than a ring's width in any lens
  constexpr double kAgreed = 0.8;
  if (start.outer.minor_px < kSmallest_px) return;
  if (start.profile.rings >= options.min_rings && start.profile.agreement >= kAgreed) return;
  const Vec2 shift = find_centre_shift(image, start.outer, grid);
  place_grid(start.outer, shift, grid);
  sample_rays(image, 0, PolarGrid::kReach, grid);
  const RadialProfile profile = read_rings(grid, options);
  if (profile.rings < options.min_rings || profile.agreement <= start.profile.agreement) return;
  start.shift = shift;
  start.profile = profile;
}

Status find_start(ImageView image, const Candidate& candidate, const DetectorOptions& options, PolarGrid& grid,
                  Start& start) {
  start.outer = candidate.outer;
  for (int reseeds = 0;; ++reseeds) {
    ROOMCAL_TRY(snap(image, grid, start.outer));
    start.profile = read_rings(grid, options);
    if (start.profile.next_outer_radius <= 1 || reseeds == kMaxReseeds) break;
    Start wider = start;
    wider.outer.major_px *= start.profile.next_outer_radius;
    wider.outer.minor_px *= start.profile.next_outer_radius;
    if (!snap(image, grid, wider.outer).ok()) break;
    start.outer = wider.outer;
  }
  allow_for_perspective(image, options, grid, start);
  if (start.profile.rings < options.min_rings) suppose_rings(start);
  if (start.profile.rings < options.min_rings || start.profile.rings > options.max_rings) {
    return refuse("profile shows no three to five dark rings");
  }
  if (start.profile.agreement < 0.55) return refuse("sectors differ");
  if (start.profile.visible < 0.4) return refuse("less than half inside the image");
  return ok_status();
}

RingModel initial_model(const Start& start) {
  RingModel model = model_from_ellipse(start.outer, start.shift);
  model.rings = start.profile.rings;
  model[kLight0] = start.profile.paper;
  model[kInk] = std::clamp(start.profile.ink / start.profile.paper, 0.0, 0.95);
  model[kBlur] = std::min(start.profile.blur_px / model.scale_px, 0.3);
  for (int edge = 1; edge < model.edges(); ++edge) {
    model[kFirstRadius + edge - 1] = start.profile.radius[static_cast<std::size_t>(edge)];
  }
  return model;
}

// Standard deviation of residuals from the median of their magnitudes, by counting; never below rounding's.
double robust_sigma(std::span<const float> magnitudes) {
  constexpr float kBinsPerGrey = 16;
  std::array<uint16_t, 1024> bin{};  // up to 64 grey levels: a fit that is worse than that is refused anyhow
  static_assert(kMaxRingPixels <= UINT16_MAX);
  for (const float magnitude : magnitudes) {
    const float place = magnitude * kBinsPerGrey;
    ++bin[place < static_cast<float>(bin.size() - 1) ? static_cast<std::size_t>(place) : bin.size() - 1];
  }
  const double half = static_cast<double>(magnitudes.size()) / 2;
  double below = 0;
  std::size_t middle = 0;
  for (; below + bin[middle] < half; ++middle) below += bin[middle];
  const double median_grey =
      (static_cast<double>(middle) + (half - below) / bin[middle]) / static_cast<double>(kBinsPerGrey);
  return std::max(1.4826 * median_grey, 0.4);
}

constexpr double kHopelessResidual = 0.3;  // markers under shadows start at 0.15 and end below 0.13
constexpr double kOutlierSigmas = 5;       // costs 3 % of the information of Gaussian noise

// A thinned set at a scale that forgives the start, then again at the noise's scale.
Status approach(ImageView image, Arena& scratch, RingPixels& all, FittedRings& fit) {
  constexpr double kTypicalNoise = 2;
  constexpr FitStop kNear{.step_px = 0.1, .cost_ratio = 0.95, .max_iterations = 8};
  constexpr FitStop kNearer{.step_px = 0.015, .cost_ratio = 0.995, .max_iterations = 8};  // all pixels do the rest
  RingPixels few;
  ROOMCAL_TRY(gather_ring_pixels(image, fit.model, kFitReach, scratch, all));
  ROOMCAL_TRY(thin_ring_pixels(all, kThinnedPixels, scratch, few));
  std::array<float, kThinnedPixels> store;
  const auto magnitudes = std::span<float>(store).first(static_cast<std::size_t>(few.count));
  fit_rings(few, {0.5 * fit.model.contrast()}, kTypicalNoise, kNear, magnitudes, fit.model);
  fit.noise_grey = robust_sigma(magnitudes);
  fit_rings(few, {kOutlierSigmas * fit.noise_grey}, fit.noise_grey, kNearer, {}, fit.model);
  if (fit.noise_grey > kHopelessResidual * fit.model.contrast()) return refuse("far from any picture of rings");
  return ok_status();
}

// The edges of a large marker are sharp beside its size: a fit sees them only from within a pixel or two. Where the
// reduced picture does not help, the full one decides as it would have.
Status approach_reduced(ImageView image, Arena& scratch, FittedRings& fit) {
  const Arena::Scope scope(scratch);
  ReducedMarker reduced;
  const Status status = reduce_marker(image, fit.model, kFitReach, scratch, reduced);
  if (status.code() == StatusCode::kOutOfMemory) return status;
  if (!status.ok()) return ok_status();
  FittedRings small;
  small.model = reduced.model;
  RingPixels pixels;
  const Status fitted = approach(reduced.image, scratch, pixels, small);
  if (fitted.code() == StatusCode::kOutOfMemory) return fitted;
  if (!fitted.ok()) return ok_status();
  reduced.model = small.model;
  RingModel full = fit.model;
  take_from_reduced(reduced, full);
  if (is_plausible(full)) fit.model = full;
  return ok_status();
}

// Coarse to fine; the last steps are undamped and on all pixels: from within a tenth of the blur, one step is good to a
// thousandth of a pixel.
Status fit_pixels(ImageView image, Arena& scratch, FittedRings& fit) {
  if (wants_reduction(fit.model)) ROOMCAL_TRY(approach_reduced(image, scratch, fit));
  RingPixels all;
  ROOMCAL_TRY(approach(image, scratch, all, fit));
  fit.pixels = all.count;
  const auto magnitudes = scratch.allocate_uninitialized<float>(static_cast<std::size_t>(all.count));
  if (magnitudes.empty()) return out_of_scratch();
  for (int step = 0; step < 4; ++step) {
    fit.tally = {};
    evaluate(fit.model, all, {kOutlierSigmas * fit.noise_grey}, magnitudes, &fit.tally, fit.evaluation);
    fit.noise_grey = robust_sigma(magnitudes);
    add_priors(fit.model, fit.noise_grey, fit.evaluation.equations);
    fit.last_step_px = newton_step(fit.evaluation.equations, fit.model);
    if (fit.last_step_px < 0.04 * fit.model.blur_px()) break;
  }
  return ok_status();
}

double outside_share(ImageView image, const RingModel& model) {
  constexpr int kPoints = 64;
  Ellipse ellipse;
  if (!ellipse_of_radius(model, 1, ellipse)) return 1;
  const Vec2 along{std::cos(ellipse.angle_rad), std::sin(ellipse.angle_rad)};
  const Vec2 across{-along.y(), along.x()};
  int outside = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2 * kPi * i / kPoints;
    const Vec2 point = ellipse.centre_px + ellipse.major_px / 2 * std::cos(angle) * along +
                       ellipse.minor_px / 2 * std::sin(angle) * across;
    const bool inside =
        point.x() >= 0 && point.y() >= 0 && point.x() <= image.width() - 1 && point.y() <= image.height() - 1;
    outside += inside ? 0 : 1;
  }
  return static_cast<double>(outside) / kPoints;
}

// How far a curve falls and rises again, grey levels.
float deepest_dip(std::span<const float> level) {
  float deepest = 0, before = 0;
  for (std::size_t i = 0; i < level.size(); ++i) {
    before = std::max(before, level[i]);
    const float after = *std::max_element(level.begin() + static_cast<std::ptrdiff_t>(i), level.end());
    deepest = std::max(deepest, std::min(before, after) - level[i]);
  }
  return deepest;
}

// Rings seen edge-on are resolved along the major axis only, and now and then the fit takes one ring's edge at one end
// and the next one's at the other. Then a dark ring lies beyond that end: light, dark and light again within half a
// radius, where the sheet's margin should be.
bool has_ring_beyond(ImageView image, const RingModel& model, const Ellipse& ellipse, PolarGrid& grid) {
  constexpr double kResolvedMinor_px = 12, kEdgeOn = 0.5, kDepth = 0.4, kFrom = 1.05, kTo = 1.6;
  if (ellipse.minor_px > kResolvedMinor_px || ellipse.minor_px > kEdgeOn * ellipse.major_px) return false;
  place_grid(ellipse, Vec2::Zero(), grid);
  sample_rays(image, kFrom, kTo, grid);
  const auto first = static_cast<std::size_t>(std::ceil(grid.sample(kFrom)));
  const auto count = static_cast<std::size_t>(grid.sample(kTo)) - first;
  for (const std::size_t end : {0, PolarGrid::kRays / 2}) {  // the first ray after the major axis, at either end
    const auto beyond = std::span<const float>(grid.level[end]).subspan(first, count);
    if (static_cast<double>(deepest_dip(beyond)) > kDepth * model.contrast()) return true;
  }
  return false;
}

bool is_sane(const Ellipse& ellipse) {
  return std::isfinite(ellipse.centre_px.x()) && std::isfinite(ellipse.centre_px.y()) &&
         std::isfinite(ellipse.angle_rad) && ellipse.minor_px > 1 && ellipse.major_px > 1 && ellipse.minor_px < 20000 &&
         ellipse.major_px < 20000;
}

}  // namespace

std::size_t refine_scratch_bytes() {
  return ring_pixels_bytes() + reduced_bytes() + kMaxRingPixels * sizeof(float) + sizeof(PolarGrid) + 1024;
}

Status refine(ImageView image, const Candidate& candidate, const DetectorOptions& options, Arena& scratch,
              Detection& detection) {
  if (!is_sane(candidate.outer)) return refuse("candidate is no ellipse");
  Arena::Scope scope(scratch);
  const std::span<PolarGrid> grid = scratch.allocate_uninitialized<PolarGrid>(1);
  if (grid.empty()) return out_of_scratch();
  Start start;
  ROOMCAL_TRY(find_start(image, candidate, options, grid[0], start));
  FittedRings fit;
  fit.model = initial_model(start);
  if (!is_plausible(fit.model)) return refuse("rings out of order");
  if (const Status fitted = fit_pixels(image, scratch, fit); !fitted.ok()) {
    return fitted.code() == StatusCode::kTooFew ? refuse(fitted.detail()) : fitted;
  }
  Detection found;
  ROOMCAL_TRY(verify_rings(fit, outside_share(image, fit.model), options, found));
  if (found.status == DetectionStatus::kOk && has_ring_beyond(image, fit.model, found.ellipse, grid[0]))
    found.status = DetectionStatus::kUnstable;
  detection = found;
  return ok_status();
}

}  // namespace roomcal::marker
