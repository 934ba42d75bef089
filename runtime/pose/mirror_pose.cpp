#include <Eigen/Eigenvalues>

#include "runtime/pose/pose_search.h"

namespace roomcal::pose {

/// A flat, distant group of markers looks nearly the same from the pose that is mirrored about the line of sight to its
/// middle (the two-fold ambiguity of planar pose estimation; Schweighofer, Pinz, PAMI 2006, section 3). Starting the
/// polish there tells whether it is a minimum of its own, and how good.
void PoseSearch::try_mirror_pose() {
  const SE3 T_room_cam = found_[0].T_room_cam;
  matcher_.match(T_room_cam, 1.0, marker_of_sight_, work_);
  Vec3 sum = Vec3::Zero();
  Mat33 sum2 = Mat33::Zero();
  int count = 0;
  for (const uint16_t marker : marker_of_sight_) {
    if (marker == kNoMarker) continue;
    const Vec3 p_cam = T_room_cam.inverse() * matcher_.index().markers()[marker].p_room;
    sum += p_cam;
    sum2 += p_cam * p_cam.transpose();
    ++count;
  }
  if (count < 3) return;
  const Vec3 middle_cam = sum / count;
  Eigen::SelfAdjointEigenSolver<Mat33> eigen;
  eigen.computeDirect(sum2 / count - middle_cam * middle_cam.transpose());
  const Vec3 normal_cam = eigen.eigenvectors().col(0);
  const Vec3 sight_cam = middle_cam.normalized();
  // Two reflections make a rotation; on the plane itself the second one changes nothing.
  const Mat33 mirror = (Mat33::Identity() - 2.0 * sight_cam * sight_cam.transpose()) *
                       (Mat33::Identity() - 2.0 * normal_cam * normal_cam.transpose());
  const SE3 T_mirrored_cam{mirror, middle_cam - mirror * middle_cam};
  const SE3 T_room_mirrored = T_room_cam * T_mirrored_cam.inverse();
  PolishedPose pose;
  pose.T_room_cam = T_room_mirrored;
  if (!refine_pose(matcher_.set(), matcher_.index(), marker_of_sight_, 15, pose.T_room_cam, pose.cov).ok()) return;
  pose.support = matcher_.match(pose.T_room_cam, 1.0, marker_of_sight_, work_);
  if (pose.support.inliers >= 3) record(pose);
}

}  // namespace roomcal::pose
