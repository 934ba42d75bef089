#pragma once

#include "runtime/marker/ring_fit.h"

namespace roomcal::marker {

/// A fitted marker and what the fit says about itself.
struct FittedRings {
  RingModel model;
  RingEvaluation evaluation;  ///< at the last step's start, all pixels
  SectorTally tally;
  int pixels = 0;           ///< evaluated
  double noise_grey = 0;    ///< robust standard deviation of the residuals
  double last_step_px = 0;  ///< centre's movement in the last Gauss-Newton step; negative if it was refused
};

/// Decides whether fitted rings are a marker, and whether it may be used. False alarms are worse than misses.
///
/// Refused (kNotFound): little contrast, residuals large against the contrast, sectors that do not show the rings,
/// rings whose width is not significant (discs and targets of one or two rings, fitted with three, end there).
/// @param outside_share  share of the outer circle that lies outside the image.
/// @param[out] detection  complete under kOk: centre, covariance, ellipse, rings, status.
Status verify_rings(const FittedRings& fit, double outside_share, const DetectorOptions& options, Detection& detection);

}  // namespace roomcal::marker
