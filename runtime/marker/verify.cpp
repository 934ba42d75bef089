#include "runtime/marker/verify.h"

#include <algorithm>
#include <cmath>

namespace roomcal::marker {
namespace {

using Covariance = std::array<std::array<double, kMaxParameters>, kMaxParameters>;

// Residual against contrast: photographs with glare and JPEG stay below 0.08, other things are above 0.2.
constexpr double kMaxResidual = 0.13;
// Rings thinner than a pixel are not what the model's blur makes of them: error along the minor axis, found by
// rendering at 5..11 px; at 20 px it is a thousandth.
constexpr double kThinRingSigma_px4 = 15;
// A ring's width must stand out of its own uncertainty by this factor.
constexpr double kRingSignificance = 8;
constexpr double kMinRingWidth = 0.03;  // of the outer radius; CCTag's thinnest is 0.1
// Width over blur times the ink's depth: thinner rings leave a swing of a few per cent, which anything may have. A
// small marker does not tell width from depth, but their product.
constexpr double kMinSwing = 0.48;
constexpr double kMinInnermost = 0.08;  // light disc in the middle: refuses bull's eyes with a dark one
// A centre worse than this helps nobody; large markers under glare still do at the same share of their size.
constexpr double kMaxCentreSigma_px = 0.15;
constexpr double kMaxCentreSigmaOverSize = 0.003;
// What a Gaussian blur leaves of a real one: found by rendering with a blur sampled at whole pixels.
constexpr double kModelSigma_px = 0.0015;
constexpr double kMaxOutlying = 0.1;  // share of pixels the fit sets aside: more is a shadow's edge or an occluder
// Correlated residual, of the contrast. Rendered markers have 0.01, photographs (glare, JPEG, sharpening) up to 0.07.
constexpr double kMaxMisfit = 0.10;
// Residual of the contrast, where it exceeds what a sensor makes: photographs stay below 0.085, a shadow that halves
// the light on a part of the marker makes 0.11 and may move the centre by a tenth of a pixel.
constexpr double kMaxNoise = 0.10;
constexpr double kSensorNoise_grey = 5;
constexpr double kTrustedMisfit = 0.02;  // below it the covariance of the fit says all
constexpr double kMinAxisRatio = 0.2;    // slant 78 degrees

constexpr Status refuse(const char* why) { return {StatusCode::kNotFound, why}; }

std::size_t at(int i) { return static_cast<std::size_t>(i); }

// Variance of radius(edge) - radius(edge + 1), noise of one grey level; the outer radius is exact.
double width_variance(const Covariance& inverse, int edge, int edges) {
  const int outer = edge - 1, inner = edge;  // indices among the inner radii
  const auto entry = [&](int i, int j) { return inverse[at(kFirstRadius + i)][at(kFirstRadius + j)]; };
  double variance = 0;
  if (outer >= 0) variance += entry(outer, outer);
  if (edge + 1 < edges) variance += entry(inner, inner);
  if (outer >= 0 && edge + 1 < edges) variance -= 2 * entry(outer, inner);
  return variance;
}

// Blur and ink are held: in a small marker they trade against all widths at once, which says nothing about whether
// the rings exist.
bool rings_are_significant(const FittedRings& fit, double major_px) {
  const RingModel& model = fit.model;
  NormalEquations held = fit.evaluation.equations;
  for (const int i : {kInk, kBlur}) held.sum[at(i)][at(i)] *= 1e6;
  Covariance inverse;
  if (!invert_equations(held, model.parameters(), kFirstRadius, model.parameters(), inverse)) return false;
  for (int edge = 0; edge < model.edges(); ++edge) {
    const double inner = edge + 1 < model.edges() ? model.radius(edge + 1) : 0.0;
    const double width = model.radius(edge) - inner;
    const double variance = width_variance(inverse, edge, model.edges()) * fit.noise_grey * fit.noise_grey;
    if (!(variance > 0) || width < kMinRingWidth || width < kRingSignificance * std::sqrt(variance)) return false;
    if (width * major_px / 2 * (1 - model[kInk]) < kMinSwing * model.blur_px()) return false;
  }
  return model.radius(model.edges() - 1) > kMinInnermost;
}

// What the inverse of the weighted equations is to be multiplied by (Huber, "Robust Statistics", section 7.6).
double residual_variance(const NormalEquations& equations) {
  const double slope = std::fmax(equations.slope, 0.3 * equations.weight);
  return equations.influence2 * equations.weight / (slope * slope);
}

struct SectorShares {
  double good = 0;  // of the sectors that have pixels
  int with_pixels = 0;
};

// A sector shows the rings if the model explains three quarters of what varies in it, beyond the noise.
SectorShares judge_sectors(const FittedRings& fit) {
  SectorShares shares;
  const double noise2 = fit.noise_grey * fit.noise_grey;
  int good = 0;
  for (int sector = 0; sector < SectorTally::kSectors; ++sector) {
    const double count = fit.tally.count[at(sector)];
    if (count < 3) continue;
    ++shares.with_pixels;
    const double unexplained = fit.tally.misfit[at(sector)] - 1.5 * count * noise2;
    good += unexplained < 0.25 * fit.tally.signal[at(sector)] ? 1 : 0;
  }
  shares.good = shares.with_pixels > 0 ? static_cast<double>(good) / shares.with_pixels : 0;
  return shares;
}

// Correlation of a residual with the next pixel's along the ring; noise has none.
double misfit_correlation(const NormalEquations& equations) {
  return std::clamp(equations.neighbours / std::fmax(equations.influence2, 1e-9), 0.0, 0.9);
}

// Root mean square of the part of the residuals that neighbours share, of the contrast: shadows, glare, sharpening.
double misfit_share(const FittedRings& fit) {
  return fit.noise_grey * std::sqrt(misfit_correlation(fit.evaluation.equations)) / fit.model.contrast();
}

// A shadow's edge, an occluder or another thing that the light's plane cannot follow.
bool is_misfit(const FittedRings& fit) {
  const bool is_noisy = fit.noise_grey > kMaxNoise * fit.model.contrast() && fit.noise_grey > kSensorNoise_grey;
  return is_noisy || fit.evaluation.outlying > kMaxOutlying * fit.pixels || misfit_share(fit) > kMaxMisfit;
}

// What a misfit may do to the centre: a share m of the contrast at an edge of this blur moves that edge by some m
// blurs, and nothing says that it averages out around the ring.
double misfit_sigma_px(const FittedRings& fit) {
  return std::fmax(0.0, misfit_share(fit) - kTrustedMisfit) * fit.model.blur_px();
}

// Variance along the minor axis.
Mat22 thin_ring_variance_px2(const Ellipse& ellipse) {
  const Vec2 minor_axis(-std::sin(ellipse.angle_rad), std::cos(ellipse.angle_rad));
  const double sigma_px = kThinRingSigma_px4 / std::pow(ellipse.minor_px, 3);
  return sigma_px * sigma_px * minor_axis * minor_axis.transpose();
}

bool is_uncertain(const FittedRings& fit, const Detection& detection) {
  if (fit.last_step_px < 0 || fit.last_step_px > 0.1 * fit.model.blur_px()) return true;
  const double max_sigma_px = std::fmax(kMaxCentreSigma_px, kMaxCentreSigmaOverSize * detection.ellipse.major_px);
  if (!(detection.cov_px2.trace() < max_sigma_px * max_sigma_px)) return true;
  return detection.ellipse.minor_px < kMinAxisRatio * detection.ellipse.major_px;
}

}  // namespace

Status verify_rings(const FittedRings& fit, double outside_share, const DetectorOptions& options,
                    Detection& detection) {
  const RingModel& model = fit.model;
  Detection found;
  if (!ellipse_of_radius(model, 1, found.ellipse)) return refuse("outer circle is no ellipse");
  if (found.ellipse.major_px < options.min_diameter_px) return refuse("smaller than min_diameter_px");
  if (model.contrast() < options.min_contrast) return refuse("contrast below min_contrast");
  if (fit.noise_grey > kMaxResidual * model.contrast()) return refuse("residuals too large for its contrast");
  const SectorShares sectors = judge_sectors(fit);
  if (sectors.good < 0.6) return refuse("too few sectors show the rings");
  Covariance inverse;
  if (!invert_equations(fit.evaluation.equations, model.parameters(), kCentreX, kCentreY + 1, inverse))
    return refuse("undetermined");
  if (!rings_are_significant(fit, found.ellipse.major_px)) return refuse("rings not significant");

  found.centre_px = model.centre_px();
  found.rings = model.rings;
  // Correlated residuals carry less information than their number says: first-order autoregression along a ring.
  const double correlation = misfit_correlation(fit.evaluation.equations);
  const double unit = residual_variance(fit.evaluation.equations) * model.scale_px * model.scale_px *
                      (1 + correlation) / (1 - correlation);
  found.cov_px2 << inverse[0][0], inverse[0][1], inverse[1][0], inverse[1][1];
  found.cov_px2 *= unit;
  const double misfit_px = misfit_sigma_px(fit);
  found.cov_px2 += (kModelSigma_px * kModelSigma_px + misfit_px * misfit_px) * Mat22::Identity();
  found.cov_px2 += thin_ring_variance_px2(found.ellipse);
  found.status = DetectionStatus::kOk;
  if (is_uncertain(fit, found)) found.status = DetectionStatus::kUnstable;
  if (is_misfit(fit)) found.status = DetectionStatus::kUnstable;
  if (sectors.good < 0.9) found.status = DetectionStatus::kOccluded;
  if (outside_share > 0) found.status = DetectionStatus::kCutByBorder;
  detection = found;
  return ok_status();
}

}  // namespace roomcal::marker
