#pragma once

#include <cstddef>
#include <span>

#include "runtime/marker/detector.h"

namespace roomcal::marker {

/// A place that may be a ring marker: what find_candidates() hands to refine().
struct Candidate {
  Ellipse outer;  ///< outer circle's image, good to about 5 % of its size
  int rings = 0;  ///< dark rings seen so far; the profile decides
  bool touches_border = false;
};

}  // namespace roomcal::marker
