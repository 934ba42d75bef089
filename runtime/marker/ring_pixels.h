#pragma once

#include "runtime/base/arena.h"
#include "runtime/marker/ring_block.h"

namespace roomcal::marker {

inline constexpr int kMaxRingPixels = 8192;

/// The pixels that know something about a marker: all near the edges of its rings, a quarter of the flat ones, thinned
/// at random (fixed hash) to kMaxRingPixels, sorted by radius.
///
/// @param model    good to about a ring's width.
/// @param reach    largest radius taken, 1.1..1.2: the sheet ends at about 1.2, anything can lie beyond.
/// @param arena    keeps the pixels (96 KiB); 144 KiB more are used and given back.
/// @return kTooFew under 40 pixels, or if `reach` meets the line at infinity; kOutOfMemory.
/// Cost: 3 ns for each pixel up to 24000, then constant.
Status gather_ring_pixels(ImageView image, const RingModel& model, double reach, Arena& arena, RingPixels& pixels);

/// `target` of the pixels at even distances, or all if there are fewer, still sorted by radius. @return kOk or
/// kOutOfMemory.
Status thin_ring_pixels(const RingPixels& pixels, int target, Arena& arena, RingPixels& thinned);

/// Arena bytes that both need together, alignment included.
std::size_t ring_pixels_bytes();

}  // namespace roomcal::marker
