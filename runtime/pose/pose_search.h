#pragma once

#include <cstdint>
#include <span>

#include "runtime/base/fixed_vector.h"
#include "runtime/pose/delaunay.h"
#include "runtime/pose/p3p.h"
#include "runtime/pose/polish.h"
#include "runtime/pose/support.h"

namespace roomcal::pose {

/// The RANSAC of [P, III-B step 3] over image triangles and the map's triangle index, with progressive verification:
/// plausible -> neighbours seen -> all markers matched -> polished. Each stage costs about ten times the one before and
/// is passed by about a hundredth of the wrong hypotheses.
class PoseSearch {
 public:
  /// @param triangles  image triangles as numbers of sights; the search reorders them.
  /// @param marker_of_sight, work  as long as the sights.
  PoseSearch(const Matcher& matcher, const LocateOptions& options, std::size_t observations,
             std::span<Triple> triangles, std::span<uint16_t> marker_of_sight, std::span<double> work);

  /// Until a pose is accepted, nothing is left to try, or max_hypotheses.
  void run();

  /// Looks for other poses that explain the image as well as the best one: triples of the same shape elsewhere in the
  /// room, and the mirror pose of a flat scene.
  void challenge();

  /// Polished poses that are clearly different from each other, by falling likelihood; all that was seen, kept to a
  /// few.
  std::span<const PolishedPose> found() const { return found_.span(); }
  /// Pose against chance, hypotheses counted; accepted from LocateOptions::min_log_odds.
  double log_odds(const Support& support) const;
  bool accepts(const Support& support) const;
  int hypotheses() const { return hypotheses_; }

 private:
  void shuffle();
  void search_by_size();
  void search_by_frequency();
  bool try_sizes(const Triple& triangle);
  bool try_triples(const Triple& triangle, std::size_t first, std::size_t last);
  void challenge_triangle(const Triple& triangle, const map::MarkerTriple& marker);
  void try_mirror_pose();
  /// @return true when the search may stop.
  bool try_pair(const P3pBearings& bearings, const Triple& sight, const map::MarkerTriple& marker);
  void verify(const SE3& T_room_cam, const Triple& sight, const map::MarkerTriple& marker);
  void polish_and_record(const SE3& T_room_cam);
  bool is_known(const SE3& T_room_cam) const;
  void record(const PolishedPose& pose);
  bool done() const;

  const Matcher& matcher_;
  const LocateOptions& options_;
  int observations_;
  std::span<Triple> triangles_;
  std::span<uint16_t> marker_of_sight_;
  std::span<double> work_;
  FixedVector<PolishedPose, 5> found_;
  P3pPoses poses_;
  int hypotheses_ = 0;
};

/// True if `other` lies farther from `pose` than its covariance can explain (Mahalanobis distance above 6).
bool is_clearly_another(const PolishedPose& pose, const SE3& T_room_cam_other);

}  // namespace roomcal::pose
