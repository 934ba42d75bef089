#pragma once

#include <array>

#include "runtime/marker/detector.h"
#include "runtime/math/types.h"

namespace roomcal::marker {

inline constexpr int kMaxRings = 5;
inline constexpr int kMaxEdges = 2 * kMaxRings;

/// Order of the unknowns of a RingModel. The inner radii follow, outermost first.
enum Parameter : int {
  kCentreX,
  kCentreY,
  kShape00,
  kShape10,
  kShape11,
  kLineX,
  kLineY,
  kLight0,
  kLightX,
  kLightY,
  kInk,
  kBlur,
  kFirstRadius,
};
inline constexpr int kMaxParameters = kFirstRadius + kMaxEdges - 1;

/// One ring marker as a picture: a homography of concentric circles, the light on them, and the blur.
///
/// With x = (p - origin_px) / scale_px, d = x - c:  r(x) = |W d| / (1 + h . d)  is 1 on the outer circle, and
///     I = L (k + (1 - k) w) + sigma^2 (1 - k) grad L . grad w,   L(x) = l0 + l1 x + l2 y,
///     w = 1 + sum_j s_j Phi((r - rho_j) / (|grad r| sigma))
/// where s_j alternates from +1 at the outer edge (rho_0 = 1), W is lower triangular, k is the ink's share of the
/// paper's reflectance. The blur is isotropic in pixels, not in r: under slant a blur in r costs a factor of five.
/// c is the projection of the circles' common centre: r = 0 there for every h.
struct RingModel {
  Vec2 origin_px = Vec2::Zero();
  double scale_px = 1;
  int rings = 0;
  std::array<double, kMaxParameters> value{};  ///< see Parameter; lengths in units of scale_px, light in grey levels

  int edges() const { return 2 * rings; }
  int parameters() const { return kFirstRadius + edges() - 1; }
  double radius(int edge) const { return edge == 0 ? 1.0 : value[static_cast<std::size_t>(kFirstRadius + edge - 1)]; }
  double& operator[](int i) { return value[static_cast<std::size_t>(i)]; }
  double operator[](int i) const { return value[static_cast<std::size_t>(i)]; }

  Vec2 centre_px() const { return origin_px + scale_px * Vec2{value[kCentreX], value[kCentreY]}; }
  double blur_px() const { return value[kBlur] * scale_px; }
  /// Grey levels between paper and ink at the centre.
  double contrast() const;
};

/// The model whose outer circle is this ellipse. Light, ink, blur and radii are left for the caller.
/// @param ellipse  both axes > 0.
/// @param shift  of the circle's projected centre in the ellipse's frame (semi-axes as units), below 1; 0: affine, h =
/// 0.
RingModel model_from_ellipse(const Ellipse& ellipse, const Vec2& shift = Vec2::Zero());

/// Image of the circle r = radius.
/// @return false if it is not an ellipse (the line at infinity cuts it); `ellipse` is untouched then.
bool ellipse_of_radius(const RingModel& model, double radius, Ellipse& ellipse);

/// r at a pixel; 1 on the outer circle.
double radius_at(const RingModel& model, const Vec2& point_px);

/// True if the numbers describe a marker at all: finite, ordered radii, positive blur, light and contrast, the line at
/// infinity well outside the outer circle. The fit refuses steps that leave this set.
bool is_plausible(const RingModel& model);

}  // namespace roomcal::marker
