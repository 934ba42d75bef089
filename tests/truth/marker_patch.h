#pragma once

#include <cstdint>
#include <vector>

#include "runtime/base/span2d.h"
#include "runtime/math/types.h"

namespace roomcal::truth {

/// One printed sheet seen by a camera, rendered without any of the detector's approximations.
///
/// The plane's unit is the marker's outer radius; H_px_plane takes plane points to pixels. Area integration by
/// supersampling, then a Gaussian blur, light, noise, rounding and clipping, in that order.
struct MarkerPatch {
  enum class Print : uint8_t { kRings, kFan, kCheckerboard, kText };

  int width = 160, height = 160;
  Mat33 H_px_plane = Mat33::Identity();
  Print print = Print::kRings;
  std::vector<double> radii{1, 0.85, 0.70, 0.55, 0.40, 0.25};  ///< black inside the first, then alternating
  double sheet_half_x = 1.235, sheet_half_y = 1.75;            ///< A4 around a marker of 85 mm radius
  double paper = 200, ink = 40, background = 110;              ///< grey levels at the marker's centre
  Vec2 light_gradient = Vec2::Zero();  ///< relative change of the light over one outer diameter D_px, per axis
  double diameter_px = 40;             ///< D_px: what light_gradient is measured over
  double blur_px = 0.8;                ///< Gaussian sigma, pixel integration excluded
  double noise_grey = 2;
  uint32_t seed = 1;
  /// Half plane in px, normal . p > offset, in which the light is multiplied by `shadow`; hard edge.
  Vec2 shadow_normal = Vec2::UnitX();
  double shadow_offset_px = 1e9, shadow = 1;
  /// Bar in front: |normal . p - offset| < half width, of level `bar_grey`; none if the half width is 0.
  Vec2 bar_normal = Vec2::UnitX();
  double bar_offset_px = 0, bar_half_px = 0, bar_grey = 90;

  /// Projection of the marker's centre.
  Vec2 centre_px() const;
};

/// H_px_plane of a pinhole camera that looks straight at the marker's centre.
/// @param diameter_px  major axis of the outer circle's image, about. @param slant_rad  between normal and ray.
/// @param azimuth_rad  direction in the image in which the sheet tilts away. @param roll_rad  of the sheet in its
/// plane.
Mat33 marker_homography(const Vec2& centre_px, double diameter_px, double slant_rad, double azimuth_rad,
                        double roll_rad, double focal_px);

/// Grey levels before noise and rounding, row-major. Cost: about 1 us per pixel on an edge.
std::vector<double> render_clean(const MarkerPatch& patch);

/// Adds noise (Gaussian, seeded), rounds and clips to 0..255.
std::vector<uint8_t> digitize(const std::vector<double>& clean, double noise_grey, uint32_t seed);

/// Both in one.
std::vector<uint8_t> render(const MarkerPatch& patch);

inline ImageView view(const MarkerPatch& patch, const std::vector<uint8_t>& pixels) {
  return {pixels.data(), patch.width, patch.height};
}

/// What the Cramer-Rao bound supposes to be unknown beside homography (7), light with gradient (3) and ink (1).
enum class Unknown : uint8_t { kNothingElse, kRadiiAndBlur };

/// Cramer-Rao bound of the projected centre's covariance, px^2, by central differences of render_clean() over the
/// pixels within 1.15 radii. Noise variance: noise_grey^2 + 1/12 for rounding.
Mat22 cramer_rao_bound(const MarkerPatch& sheet, Unknown unknown);

}  // namespace roomcal::truth
