#pragma once

#include <span>

#include "runtime/base/fixed_vector.h"
#include "runtime/base/status.h"
#include "runtime/math/se3.h"

namespace roomcal::pose {

/// Up to four poses of a camera, T_room_cam.
using P3pPoses = FixedVector<SE3, 4>;

/// What P3P needs of three bearings; prepared once, used against many map triples.
class P3pBearings {
 public:
  P3pBearings() = default;
  /// @param bearing_cam  [3] unit vectors, camera frame.
  explicit P3pBearings(std::span<const Vec3, 3> bearing_cam);

  /// False when the three bearings lie in one plane with the camera's centre (zero solid angle).
  bool valid() const { return valid_; }

 private:
  friend Status solve_p3p(const P3pBearings&, std::span<const Vec3, 3>, P3pPoses&);

  Mat33 basis_ = Mat33::Identity();  // rows b1, k3, b1 x k3 [eq. 8]
  Vec3 b1_ = Vec3::UnitZ();
  Vec3 b2_ = Vec3::UnitZ();
  Vec3 b3_ = Vec3::UnitZ();
  double cos12_ = 0;  // b1 . b2
  double sin12_ = 0;  // |b1 x b2|
  double k3_b3_ = 0;
  double k3_v1_ = 0;  // k3 . (b1 x b3)
  double k3_v2_ = 0;  // k3 . (b2 x b3)
  bool valid_ = false;
};

/// Camera poses that see three map points at three bearings (up to four).
///
/// Each answer satisfies  depth[i] * bearing_cam[i] = T_room_cam^-1 * point_room[i],  depth[i] > 0.
/// Source: Ke, Roumeliotis, "An Efficient Algebraic Solution to the Perspective-Three-Point Problem", CVPR 2017,
/// section 3 and Algorithm 1 (AP3P): rotation first, as a quartic in cos(theta_1'), then the position.
///
/// @param point_room  [3] metres, room frame; must not be collinear.
/// @param[out] T_room_cam  cleared first; order means nothing.
/// @return kOk (zero poses is a value); kDegenerate if the points or the bearings span no triangle.
/// Cost: bounded, about half a microsecond; no allocation; safe from any thread.
Status solve_p3p(const P3pBearings& bearings, std::span<const Vec3, 3> point_room, P3pPoses& T_room_cam);
Status solve_p3p(std::span<const Vec3, 3> bearing_cam, std::span<const Vec3, 3> point_room, P3pPoses& T_room_cam);

}  // namespace roomcal::pose
