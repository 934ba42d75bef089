#pragma once

#include <cmath>

namespace roomcal {

/// A robust loss at a squared residual: its value and the weight d rho / d s of the reweighted least squares.
struct LossAndWeight {
  double loss;
  double weight;
};

/// Least squares inside, redescending outside: with s = |r|^2 of a whitened residual and the turn-over k in sigmas,
///     rho(s) = s for s <= k^2,   k^2 (3 - 2 k / sqrt(s)) beyond;      weight = 1, then (k / sqrt(s))^3.
///
/// Inside it is exact least squares, so the inverse of the weighted information is the covariance: with k = 3 and
/// clean 2-D residuals 1.1 % are touched. (Geman-McClure weighs every residual down, by a quarter on the average at
/// k = 3, and its information would have to be corrected.) Outside the pull falls with 1 / r^2 (Huber's stays at k: 5 %
/// of wild points then inflate the scatter by a tenth and more), and the loss is bounded, so an observation that cannot
/// even be projected has a cost: max_loss().
class RedescendingLoss {
 public:
  explicit RedescendingLoss(double turn_over) : k_(turn_over) {}

  LossAndWeight operator()(double s) const {
    if (s <= k_ * k_) return {s, 1};
    const double ratio = k_ / std::sqrt(s);
    return {k_ * k_ * (3 - 2 * ratio), ratio * ratio * ratio};
  }

  double max_loss() const { return 3 * k_ * k_; }

  /// Weight below which an observation counts as an outlier: 2.15 k away.
  static constexpr double kOutlierWeight = 0.1;

 private:
  double k_;
};

}  // namespace roomcal
