#pragma once

#include "runtime/base/status.h"
#include "runtime/camera/camera.h"
#include "runtime/math/se3.h"

namespace roomcal::rig {

/// Where a map point appears, against where it was seen:  residual = project(T_room_cam^-1 p_room) - centre.
struct Reprojection {
  Vec2 residual_px;
  Mat26 J_pose;   ///< d residual / d xi for T_room_cam * se3_exp(xi); px per (m, rad)
  Mat23 J_point;  ///< d residual / d p_room; px per m
  Eigen::Matrix<double, 2, camera::kIntrinsicsCount> J_intrinsics;  ///< d residual / d (fx fy cx cy d0 d1 d2 d3)
};

/// Residual alone. @param[out] residual_px  untouched unless kOk. @return what Camera::project() says.
Status reproject(const camera::Camera& camera, const SE3& T_room_cam, const Vec3& p_room, const Vec2& centre_px,
                 Vec2& residual_px);

/// Residual and derivatives. @param[out] out  untouched unless kOk. @return what Camera::project() says.
Status reproject(const camera::Camera& camera, const SE3& T_room_cam, const Vec3& p_room, const Vec2& centre_px,
                 Reprojection& out);

}  // namespace roomcal::rig
