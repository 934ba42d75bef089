#pragma once

#include "runtime/marker/ring_block.h"

namespace roomcal::marker {

/// How well the model describes the pixels in sixteen sectors of the marker; sums are not weighted.
struct SectorTally {
  static constexpr int kSectors = 16;
  std::array<double, kSectors> misfit{};  ///< sum of squared residuals
  std::array<double, kSectors> signal{};  ///< sum of squared deviations of the model from its mean level
  std::array<double, kSectors> count{};
};

/// Result of one evaluation of a model over a pixel set.
struct RingEvaluation {
  NormalEquations equations;
  int outlying = 0;  ///< pixels set aside: weight below a quarter, the clipped ones apart
};

/// Evaluates model and Jacobian at every pixel. @param absolute_residual  count entries, or empty.
void evaluate(const RingModel& model, const RingPixels& pixels, const ResidualWeighting& weighting,
              std::span<float> absolute_residual, SectorTally* tally, RingEvaluation& evaluation);

/// Adds what is known of every marker beforehand, as observations of noise `noise_grey`.
void add_priors(const RingModel& model, double noise_grey, NormalEquations& equations);

/// When to stop: a step is shorter than `step_px`, or leaves more than `cost_ratio` of the cost.
struct FitStop {
  double step_px = 0.015;
  double cost_ratio = 0.995;  ///< what still moves at an even cost is blur against ink, not the centre
  int max_iterations = 8;
};

/// Levenberg-Marquardt from `model`, which never leaves is_plausible().
/// @param[out] absolute_residual  of the final model, grey levels: count entries, or empty.
/// @return iterations that lowered the cost.
int fit_rings(const RingPixels& pixels, const ResidualWeighting& weighting, double noise_grey, const FitStop& stop,
              std::span<float> absolute_residual, RingModel& model);

/// One undamped Gauss-Newton step. @return its length in the centre, px; negative if refused.
double newton_step(const NormalEquations& equations, RingModel& model);

/// Inverse of the normal equations: covariance per unit of noise variance (grey^2), in model units.
/// @param first,last  columns wanted, `last` not included; others are left as they were. @return false if singular.
/// Rows of unknowns without information (a ring out of sight) are zero.
bool invert_equations(const NormalEquations& equations, int parameters, int first, int last,
                      std::array<std::array<double, kMaxParameters>, kMaxParameters>& inverse);

}  // namespace roomcal::marker
