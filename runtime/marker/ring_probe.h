#pragma once

#include "runtime/base/span2d.h"
#include "runtime/marker/candidate.h"
#include "runtime/marker/components.h"

namespace roomcal::marker {

/// Looks along 32 rays from a blob's centre for the edges that a concentric marker must have outside it.
///
/// All circles of a marker are imaged as ellipses of nearly the same shape and centre, so an edge of the marker lies on
/// all rays at the same multiple of the blob's own ellipse. Edges are voted for, ray by ray: shadows, cables and merged
/// rings take away votes, they do not move the edge. The outermost edge of the alternation that begins at the blob is
/// the marker's outer circle; an ellipse is fitted to it.
///
/// @param blob       light disc, or any concentric ellipse of the marker; `blob.dark` gives the sense of its edge.
/// @param[out] found written only on success.
/// @return false if no dark ring was found outside a light blob, or no light middle inside a dark blob without one.
/// Cost: 3 to 10 us.
bool probe_rings(ImageView image, const Blob& blob, const DetectorOptions& options, Candidate& found);

}  // namespace roomcal::marker
