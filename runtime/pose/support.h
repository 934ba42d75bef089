#pragma once

#include <cstdint>
#include <span>

#include "runtime/base/fixed_vector.h"
#include "runtime/map/triangle_index.h"
#include "runtime/math/se3.h"
#include "runtime/pose/sight.h"

namespace roomcal::pose {

inline constexpr uint16_t kNoMarker = 65535;

/// How well a pose explains the sights.
struct Support {
  int inliers = 0;
  /// log of  prod_i ((1 - w) + w N(residual_i) / density of markers in the field):  pose against chance.
  double log_likelihood = 0;
};

/// Matches predicted markers with sights, one to one; the shared core of verification, polish and judgement.
class Matcher {
 public:
  Matcher(const SightSet& set, const map::TriangleIndex& index);

  /// Cheap first look at a minimal solution: the camera is inside the room, the three markers face it and have the size
  /// and slant that was seen.
  bool is_plausible(const SE3& T_room_cam, const std::array<uint16_t, 3>& sight, const map::MarkerTriple& marker) const;

  /// How many map neighbours of the triple are seen where the pose puts them, counted up to `enough`.
  int neighbours_seen(const SE3& T_room_cam, const map::MarkerTriple& marker, double gate_scale, int enough) const;

  /// The full match. @param gate_scale  1 for a polished pose, more for a minimal solution.
  /// @param[out] marker_of_sight  marker number or kNoMarker; as long as the sights.
  /// @param work  as long as the sights.
  /// Cost: linear in the map, a few microseconds.
  Support match(const SE3& T_room_cam, double gate_scale, std::span<uint16_t> marker_of_sight,
                std::span<double> work) const;

  const SightSet& set() const { return set_; }
  const map::TriangleIndex& index() const { return index_; }

 private:
  bool looks_like(const Sight& sight, const map::IndexedMarker& marker, const Vec3& to_camera_room,
                  double tolerance) const;

  const SightSet& set_;
  const map::TriangleIndex& index_;
  Vec3 low_room_;  // of where a camera may stand
  Vec3 high_room_;
};

/// Covariance of a residual in the tangent plane: the sight's own and the marker's, seen from the camera.
Mat22 residual_covariance(const Sight& sight, const map::IndexedMarker& marker, const Mat33& R_room_cam,
                          double range_m);

}  // namespace roomcal::pose
