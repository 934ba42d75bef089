#pragma once

#include <string>
#include <vector>

#include "tools/bake/bundle.h"
#include "tools/bake/loop_closure.h"

namespace roomcal::tools {

/// What happens to the stereo calibration given.
enum class RefineRig {
  kIfContradicted,  ///< refined, held by the prior, if that makes the residuals clearly smaller; else believed as given
  kAlways,
  kNever
};

struct ReconstructOptions {
  TrackOptions track;
  LoopOptions loop;
  RefineRig refine_rig = RefineRig::kIfContradicted;
  RigPrior prior;
  std::size_t min_views = 3;  ///< a marker seen from fewer stops is left out
  int max_rounds = 8;
};

/// What the reconstruction says about itself, beside its points and poses.
struct ReconstructSummary {
  std::vector<std::size_t> views_without_markers;  ///< fewer than TrackOptions::min_points in both images
  std::vector<std::size_t> views_lost;             ///< markers seen, but they fit nowhere
  std::size_t loops_joined = 0, merged = 0;
  int rounds = 0;
  std::array<double, 2> sigma_px{1, 1};
  std::array<double, 2> sigma_held_px{1, 1};  ///< with the calibration as given
  bool refined = false;                       ///< the calibration
  /// Refined only: the map times this is as large as the calibration given, taken as a whole, measured it.
  double scale_as_given = 1;
  BundleSummary bundle;
};

/// From sightings to points and poses: stereo correspondence, tracking, loop closure, merging, bundle adjustment
/// [P, III-A], then assignment and adjustment in turn until nothing changes.
/// @throws ToolError for sides swapped, a calibration that does not fit, no markers, two rooms in one survey.
Reconstruction reconstruct(const Survey& survey, const StereoRig& rig, const ReconstructOptions& options,
                           ReconstructSummary& summary);

}  // namespace roomcal::tools
