#pragma once

#include <span>

#include "runtime/base/fixed_vector.h"
#include "runtime/scan/acceptance.h"
#include "runtime/scan/hypotheses.h"
#include "runtime/scan/refine.h"

namespace roomcal::scan {

/// A settled place in the room.
struct Candidate {
  RangeState state;
  double loss = 0;                    ///< mean_loss() over the sample
  double mapped_loss = 0;             ///< mean over the rays with a prediction only
  Mat66 information = Mat66::Zero();  ///< of the sample; faces without evidence are muted
};

/// Fills loss and information of a candidate from the sample.
FitShares judge(std::span<const RayBlock> sample, const RefineInput& input, Candidate& candidate);

inline constexpr std::size_t kMaxTwins = 16;

/// Places that may be right: the best of the settled hypotheses and all that fit nearly as well, best first.
///
/// "As well" is asked twice: over all rays, and over those with a prediction. A flipped pose that puts an unknown
/// ceiling on the floor explains more points, and worse. Two states are one place if either's information does not tell
/// them apart: an axis that is open does not make twins.
struct CandidateSet {
  FixedVector<Candidate, kMaxTwins> twins;

  /// @param accept  states that fail it are not taken, but the best of them is if there is no other.
  /// @param twin_loss  see LocateOptions.
  void settle_all(const Samples& samples, const RefineInput& input, const Hypotheses& hypotheses,
                  const AcceptanceLimits& accept, double twin_loss);

 private:
  void insert(const Candidate& candidate);
  void drop_worse(double twin_loss);
};

}  // namespace roomcal::scan
