#pragma once

#include "runtime/base/span2d.h"
#include "runtime/marker/components.h"
#include "runtime/marker/threshold.h"

namespace roomcal::marker {

/// Ellipse of a region that the image's border cuts: follows its outline and fits the longest part off the border.
///
/// A disc cut by the border has one such part; a ring has two, and the outer one is the longer.
///
/// @return false if the outline is too short, too long, or no part of an ellipse.
/// Cost: 20 ns per pixel of outline, 4096 at the most.
bool fit_cut_piece(ImageView image, const ThresholdMap& map, const CutPiece& piece, Blob& blob);

}  // namespace roomcal::marker
