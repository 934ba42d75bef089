#pragma once

#include "runtime/base/arena.h"
#include "runtime/marker/detector.h"
#include "runtime/marker/polar_grid.h"
#include "runtime/marker/ring_model.h"

namespace roomcal::marker {

/// Moves an ellipse onto the dark-to-light edge nearest to it (robust conic fit to one edge point a ray).
/// @param window  largest relative distance of an edge, 0.1..0.25.
/// @param[out] support  share of the rays inside the image whose edge agrees with the fit.
/// @return kNotFound if fewer than a quarter of the rays agree; `ellipse` is untouched then.
Status snap_to_outer_edge(const PolarGrid& grid, double window, Ellipse& ellipse, double& support);

/// What the rays say about the rings between the centre and the outer circle.
struct RadialProfile {
  int rings = 0;                           ///< dark rings; 0 if the profile does not alternate
  std::array<double, kMaxEdges> radius{};  ///< edges, outermost (1) first
  double paper = 0, ink = 0;               ///< grey levels
  double blur_px = 1;                      ///< rough
  double agreement = 0;                    ///< share of visible rays that follow the mean profile
  double visible = 0;                      ///< share of rays that lie in the image up to the outer circle
  double next_outer_radius = 0;            ///< > 1: a dark ring surrounds this one and ends there; 0: none
};

/// Reads the mean profile along the major axis, where blur merges the rings last.
/// @param swing  least change between neighbouring extrema that counts, share of the profile's range.
RadialProfile read_profile(const PolarGrid& grid, double swing);

}  // namespace roomcal::marker
