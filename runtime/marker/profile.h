#pragma once

#include "runtime/base/arena.h"
#include "runtime/marker/detector.h"
#include "runtime/marker/ring_model.h"

namespace roomcal::marker {

/// Rays from the projected centre of a circle: sample (ray, j) lies at radius rho = (j + 1/2) * spacing of the outer
/// circle, p = centre + A z(rho u), u = (cos phi, sin phi). Samples outside the image hold -1.
///
/// Seen from far, z is the identity. Seen from near, the circle's centre is not the ellipse's: it lies at `shift` in
/// the ellipse's frame, and z(p) = (shift + p_along + sqrt(1 - shift^2) p_across) / (1 + shift . p) is the homography
/// that keeps the unit circle and takes 0 there.
struct PolarGrid {
  static constexpr int kRays = 32;
  static constexpr int kMaxSamples = 112;
  static constexpr double kReach = 1.75;  ///< largest rho sampled

  Vec2 centre_px = Vec2::Zero();
  Mat22 A = Mat22::Identity();  ///< columns: semi-axes, px
  Vec2 shift = Vec2::Zero();    ///< |shift| < 1
  double spacing = 0;           ///< in rho
  int samples = 0;
  std::array<Vec2, kRays> direction{};  ///< (cos phi, sin phi)
  std::array<std::array<float, kMaxSamples>, kRays> level{};

  double radius(double sample) const { return (sample + 0.5) * spacing; }
  double sample(double rho) const { return rho / spacing - 0.5; }
};

/// Lays the rays of a grid around an ellipse; `level` is left as it was.
/// @param shift  of the circle's projected centre in the ellipse's frame; 0 for a marker seen from far.
void place_grid(const Ellipse& ellipse, const Vec2& shift, PolarGrid& grid);

/// Samples the image bilinearly along the rays, for rho in [from, to]; the rest of `level` is left as it was.
/// Cost: about 3 ns a sample, 10 us for all of a 60 px marker.
void sample_rays(ImageView image, double from, double to, PolarGrid& grid);

/// Moves an ellipse onto the dark-to-light edge nearest to it (robust conic fit to one edge point a ray).
/// @param window  largest relative distance of an edge, 0.1..0.25.
/// @param[out] support  share of the rays inside the image whose edge agrees with the fit.
/// @return kNotFound if fewer than a quarter of the rays agree; `ellipse` is untouched then.
Status snap_to_outer_edge(const PolarGrid& grid, double window, Ellipse& ellipse, double& support);

/// The shift at which all rays show the same rings best, for a marker so large that perspective bends it.
/// @param grid  used for sampling; holds another shift's samples afterwards.
/// Cost: 2 ms.
Vec2 find_centre_shift(ImageView image, const Ellipse& ellipse, PolarGrid& grid);

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
