#include "runtime/rig/reprojection.h"

namespace roomcal::rig {

namespace {

Vec3 to_camera(const SE3& T_room_cam, const Vec3& p_room) { return T_room_cam.R.transpose() * (p_room - T_room_cam.t); }

}  // namespace

Status reproject(const camera::Camera& camera, const SE3& T_room_cam, const Vec3& p_room, const Vec2& centre_px,
                 Vec2& residual_px) {
  Vec2 px;
  ROOMCAL_TRY(camera.project(to_camera(T_room_cam, p_room), px));
  residual_px = px - centre_px;
  return ok_status();
}

Status reproject(const camera::Camera& camera, const SE3& T_room_cam, const Vec3& p_room, const Vec2& centre_px,
                 Reprojection& out) {
  const Vec3 p_cam = to_camera(T_room_cam, p_room);
  Vec2 px;
  camera::ProjectJacobians J;
  ROOMCAL_TRY(camera.project(p_cam, px, &J));
  out.residual_px = px - centre_px;
  // (T exp(xi))^-1 p = exp(-xi) p_cam = p_cam - rho + p_cam x phi to first order.
  out.J_pose.leftCols<3>() = -J.J_point;
  out.J_pose.rightCols<3>() = J.J_point * hat(p_cam);
  out.J_point = J.J_point * T_room_cam.R.transpose();
  out.J_intrinsics = J.J_intrinsics;
  return ok_status();
}

}  // namespace roomcal::rig
