#pragma once

#include "runtime/base/arena.h"
#include "runtime/base/span2d.h"
#include "runtime/marker/ring_model.h"

namespace roomcal::marker {

/// A large marker's picture made small, where a fit finds the edges from a start that is some pixels off.
struct ReducedMarker {
  ImageView image;
  RingModel model;            ///< the same marker in pixels of `image`
  int factor = 1;             ///< full pixels that one reduced pixel is the mean of, per axis
  Vec2 shift = Vec2::Zero();  ///< model coordinates here = those in the full image + shift
};

/// True if the marker is so large that its fit should start from a reduced picture.
bool wants_reduction(const RingModel& model);

/// Means over squares of pixels around the marker; its outer circle is 120..240 px wide then.
/// @param reach  largest radius that the fit will look at.
/// @param arena  keeps the reduced image.
/// @return kTooFew if nothing of it lies in the image or it reaches the horizon; kOutOfMemory.
/// Cost: 0.3 ns for each pixel of its bounding box.
Status reduce_marker(ImageView image, const RingModel& model, double reach, Arena& arena, ReducedMarker& reduced);

/// Takes geometry, radii, light and ink of `reduced.model` back to the full image; the blur stays as it was there.
void take_from_reduced(const ReducedMarker& reduced, RingModel& model);

/// Arena bytes that reduce_marker() needs at most.
std::size_t reduced_bytes();

}  // namespace roomcal::marker
