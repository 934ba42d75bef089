#pragma once

#include <cstddef>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/span2d.h"
#include "runtime/base/status.h"
#include "runtime/marker/candidate.h"

namespace roomcal::marker {

/// Where find_candidates() writes, and what it counted.
struct CandidateList {
  std::span<Candidate> items;
  std::size_t count = 0;
  int components = 0;  ///< dark regions of the image
  int probed = 0;      ///< places looked at along rays
  int dropped = 0;     ///< found, but no room in a table: the caller must tell
};

/// Adds a candidate unless the same ellipse is in the list; counts it as dropped if the list is full.
void add_candidate(const Candidate& candidate, CandidateList& list);

/// Candidates that find_candidates() may return for an image of this size: far more than markers fit into it.
std::size_t candidate_capacity(int width_px, int height_px);

/// Bytes that find_candidates() needs: the list, which stays, and what it gives back on return.
std::size_t candidates_bytes(int width_px, int height_px);

/// Places in the image that may be a ring marker, each once. Recall comes first: refine() judges.
///
/// Two passes: the image as it is finds small markers; at half its size, with another split of dark and light, noise,
/// blur and hard shadows do less harm to the larger ones. What the first pass found is not looked at again.
/// small_markers.h then looks for those that no threshold resolves. In each pass, threshold.h makes dark and light,
/// components.h finds nested concentric ellipses, ring_probe.h finds each nest's outer circle.
///
/// @param[out] list  its items lie in `arena`.
/// @return kOk; kOutOfMemory.
/// Cost: about 1 ms per megapixel.
Status find_candidates(ImageView image, const DetectorOptions& options, Arena& arena, CandidateList& list);

}  // namespace roomcal::marker
