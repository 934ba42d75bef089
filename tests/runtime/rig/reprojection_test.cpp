#include "runtime/rig/reprojection.h"

#include <gtest/gtest.h>

#include "runtime/math/numeric_diff.h"
#include "tests/truth/synthetic_room.h"

namespace roomcal::rig {
namespace {

// Points about a camera at a general pose, over lenses that look ahead and behind.
template <typename F>
void for_each_case(const F& f) {
  truth::Random random(7);
  for (const auto lens : {truth::LensKind::kNarrow, truth::LensKind::kWide, truth::LensKind::kFisheye}) {
    const camera::Camera camera = truth::make_camera(lens);
    for (int i = 0; i < 50; ++i) {
      const SE3 T_room_cam = se3_exp(random.normals<6>());
      const double reach = lens == truth::LensKind::kNarrow ? 0.3 : lens == truth::LensKind::kWide ? 1.0 : 1.8;
      const double angle_rad = random.uniform(0, reach), azimuth_rad = random.uniform(-kPi, kPi);
      const Vec3 bearing_cam{std::sin(angle_rad) * std::cos(azimuth_rad), std::sin(angle_rad) * std::sin(azimuth_rad),
                             std::cos(angle_rad)};
      f(camera, T_room_cam, T_room_cam * (random.uniform(0.5, 4) * bearing_cam));
    }
  }
}

Vec2 residual(const camera::Camera& camera, const SE3& T_room_cam, const Vec3& p_room) {
  Vec2 r(1e9, 1e9);
  EXPECT_TRUE(reproject(camera, T_room_cam, p_room, {100, 200}, r).ok());
  return r;
}

TEST(Reprojection, Jacobians_MeetNumericDerivatives) {
  for_each_case([](const camera::Camera& camera, const SE3& T_room_cam, const Vec3& p_room) {
    Reprojection out;
    ASSERT_TRUE(reproject(camera, T_room_cam, p_room, {100, 200}, out).ok());
    const auto of_pose = [&](const Vec6& xi) -> Vec2 { return residual(camera, T_room_cam * se3_exp(xi), p_room); };
    const auto of_point = [&](const Vec3& p) -> Vec2 { return residual(camera, T_room_cam, p); };
    const Mat26 J_pose = numeric_jacobian<2, 6>(of_pose, Vec6::Zero());
    const Mat23 J_point = numeric_jacobian<2, 3>(of_point, p_room);
    EXPECT_LT((out.J_pose - J_pose).norm(), 1e-7 * J_pose.norm());
    EXPECT_LT((out.J_point - J_point).norm(), 1e-7 * J_point.norm());
    EXPECT_EQ(out.residual_px, residual(camera, T_room_cam, p_room));
  });
}

TEST(Reprojection, PointOutsideTheField_IsRefusedAndLeavesTheOutput) {
  const camera::Camera camera = truth::make_camera(truth::LensKind::kNarrow);
  Reprojection out;
  out.residual_px = {3, 4};
  EXPECT_EQ(reproject(camera, SE3{}, {0, 0, -1}, {0, 0}, out).code(), StatusCode::kOutOfRange);
  EXPECT_EQ(out.residual_px, Vec2(3, 4));
  EXPECT_EQ(reproject(camera, SE3{}, {0, 0, -1}, {0, 0}, out.residual_px).code(), StatusCode::kOutOfRange);
  EXPECT_EQ(out.residual_px, Vec2(3, 4));
}

}  // namespace
}  // namespace roomcal::rig
