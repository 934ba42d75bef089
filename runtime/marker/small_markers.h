#pragma once

#include <cstddef>

#include "runtime/base/arena.h"
#include "runtime/base/span2d.h"
#include "runtime/base/status.h"
#include "runtime/marker/candidate.h"
#include "runtime/marker/candidates.h"

namespace roomcal::marker {

/// Bytes that find_small_markers() takes from its arena and gives back.
std::size_t small_markers_bytes(int width_px);

/// Adds markers of 12 to 26 px whose rings and margin no threshold separates.
///
/// Blur leaves of such a marker a grey ellipse with a lighter speck in its middle, and of the sheet's margin a rim
/// little lighter than the wall. The speck is found as a pixel above a circle of eight around it; the rim by the
/// steepest rise along rays, which an ellipse must explain.
///
/// @param min_rise  grey levels that the speck rises above the grey around it; more than noise does.
/// @return kOk; kOutOfMemory.
/// Cost: 0.1 ms per megapixel and 2 us per speck.
Status find_small_markers(ImageView image, const DetectorOptions& options, int min_rise, Arena& arena,
                          CandidateList& list);

}  // namespace roomcal::marker
