#pragma once

#include <optional>
#include <vector>

#include "tools/bake/reconstruction.h"
#include "tools/bake/rig_prior.h"

namespace roomcal::tools {

struct BundleOptions {
  std::array<double, 2> sigma_px{1, 1};  ///< of a measurement with unit covariance (normalize_covariances), per side
  double loss_sigmas = 2;                ///< Cauchy's scale
  int max_iterations = 50;
  bool refine_rig = false;
  std::optional<StereoRig> given_rig;  ///< what the prior is centred on; default: the reconstruction's
  RigPrior prior;
};

struct BundleSummary {
  bool converged = false;
  int iterations = 0;
  double cost = 0;
  std::size_t residuals = 0;  ///< measurements (pairs of numbers)
};

/// Global bundle adjustment [P, III-A 3]: all placed views and all points that they measured, in both images, robust
/// (Cauchy). Every view and point is free but the first view, which holds the gauge; scale comes from the baseline
/// (or from its prior, which is the same: images alone say nothing about scale).
///
/// A point's covariance becomes that of its own rays with the poses held: good enough to match by. The whole one:
/// map_covariance.h.
/// Cost: linear in the measurements plus points^3 per iteration. One thread, so that sums keep their order.
BundleSummary bundle_adjust(const Survey& survey, Reconstruction& map, const BundleOptions& options);

/// Lengths of all residuals of one side, px.
std::vector<double> residual_lengths(const Survey& survey, const Reconstruction& map, Side side);

/// Standard deviation per axis from the median length: half of all 2-D normal residuals are within 1.177 sigma.
std::array<double, 2> robust_sigma_px(const Survey& survey, const Reconstruction& map);

}  // namespace roomcal::tools
