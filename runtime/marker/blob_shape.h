#pragma once

#include "runtime/marker/components.h"

namespace roomcal::marker {

/// Smaller components are no part of a marker that can be measured, or no more than a hint of its centre.
inline constexpr int kMinBlobPx = 2;
/// A component at the border is worth tracing from here.
inline constexpr int kMinCutPiecePx = 8;

/// Ellipse from the eight supports of a region: a width w in direction n has (w / 2)^2 = n^T S^2 n.
///
/// Eight numbers for five unknowns: what is left over tells ellipses (and circles) from bars, corners and letters.
/// @return false if the supports contradict an ellipse by more than pixel steps and perspective explain.
bool fit_blob(const Extent& extent, Blob& blob);

/// Same centre and same shape within what perspective does, and `inner` really inside.
bool concentric(const Blob& outer, const Blob& inner);

/// A blob with nothing concentric inside: the light disc in a marker's middle, or a marker too small to show it.
/// @param area_px  of the region: light noise fills half of its outline, a disc all of it.
bool worth_keeping_alone(const Blob& blob, int area_px);

/// Half axes of the blob, px.
double half_major(const Blob& blob);
double half_minor(const Blob& blob);

}  // namespace roomcal::marker
