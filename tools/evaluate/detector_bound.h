#pragma once

#include "runtime/camera/camera.h"
#include "tools/simulate/marker_field.h"

namespace roomcal::tools {

/// Cramer-Rao bounds of a marker centre's covariance at a pixel noise of 1 grey level; they grow with its square.
struct CentreBound {
  Mat22 cov_known_px2 = Mat22::Zero();  ///< nothing but the centre unknown
  Mat22 cov_px2 = Mat22::Zero();        ///< unknown: homography (7), light with its gradient (3), ink (1)
  Mat22 cov_full_px2 = Mat22::Zero();   ///< radii of the inner circles (5) and blur (1) unknown as well
};

/// Smooth image model: a homography of concentric circles, each edge a Gaussian integral across it in pixels, times a
/// linear light. Fisher information by central differences over the pixels of the marker and the paper around it.
/// Independent of the detector's model: unknowns are those of the picture, not of any fit.
///
/// @param blur_px  sigma of the point spread; the pixel's own square is added (1/12 px^2)
/// Cost: 4 us per pixel, at most 15,000 pixels (a regular share of larger markers').
CentreBound centre_bound(const FieldMarker& marker, const camera::Camera& camera, const FieldOptions& field,
                         double blur_px);

}  // namespace roomcal::tools
