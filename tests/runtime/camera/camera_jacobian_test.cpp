#include <gtest/gtest.h>

#include "runtime/camera/parameters.h"
#include "runtime/math/numeric_diff.h"
#include "tests/runtime/camera/lenses.h"

namespace roomcal::camera {
namespace {

using test::bearing_at;
using test::kLenses;
using test::make_camera;

// Inside by enough that the differences' arms stay in the field too.
constexpr double kFractions[] = {0, 1e-3, 0.05, 0.3, 0.6, 0.9, 0.98};
constexpr int kAzimuths = 8;

Vec2 project(const Camera& camera, const Vec3& point_cam) {
  Vec2 px(1e9, 1e9);
  EXPECT_TRUE(camera.project(point_cam, px).ok());
  return px;
}

template <typename F>
void for_each_point(const F& f) {
  for (const auto& lens : kLenses) {
    const Camera camera = make_camera(lens);
    for (const double fraction : kFractions)
      for (int i = 0; i < kAzimuths; ++i)
        f(lens, camera, 1.7 * bearing_at(fraction * camera.max_angle_rad(), 0.2 + 2 * kPi * i / kAzimuths));
  }
}

TEST(CameraJacobian, OfThePoint_MeetsNumericDerivative) {
  for_each_point([](const test::Lens& lens, const Camera& camera, const Vec3& point) {
    Vec2 px;
    ProjectJacobians jacobians;
    ASSERT_TRUE(camera.project(point, px, &jacobians).ok());
    // The step shrinks towards the edge of a pinhole's field, where 1/z makes the third derivatives large.
    const double step = 1e-5 * std::min(1.0, std::abs(point.z()));
    const Mat23 J = numeric_jacobian<2, 3>([&](const Vec3& p) -> Vec2 { return project(camera, p); }, point, step);
    EXPECT_LT((jacobians.J_point - J).norm(), 1e-6 * J.norm()) << lens.name << " " << point.transpose();
    // The length of the point does not matter, so moving along it does nothing.
    EXPECT_LT((jacobians.J_point * point).norm(), 1e-12 * J.norm()) << lens.name;
  });
}

TEST(CameraJacobian, OfTheIntrinsics_MeetsNumericDerivative) {
  for_each_point([](const test::Lens& lens, const Camera& camera, const Vec3& point) {
    Vec2 px;
    ProjectJacobians jacobians;
    ASSERT_TRUE(camera.project(point, px, &jacobians).ok());
    const Intrinsics& in = lens.intrinsics;
    const Parameters p = parameters_of(in);
    const auto f = [&](const Parameters& q) -> Vec2 {
      return project(Camera::create(with_parameters(in, q)).value(), point);
    };
    // Projection is linear in each parameter on its own: any step does, as long as the field stays as wide.
    const auto J = numeric_jacobian<2, kIntrinsicsCount>(f, p, 1e-6);
    const double scale = 1 + J.norm();
    EXPECT_LT((jacobians.J_intrinsics - J).norm(), 1e-6 * scale) << lens.name << " " << point.transpose();
  });
}

TEST(CameraJacobian, OfUnproject_MeetsNumericDerivativeAndIsTangent) {
  for_each_point([](const test::Lens& lens, const Camera& camera, const Vec3& point) {
    const Vec2 px = project(camera, point);
    Vec3 bearing;
    Mat32 J_px;
    ASSERT_TRUE(camera.unproject(px, bearing, &J_px).ok());
    const auto f = [&](const Vec2& q) -> Vec3 {
      Vec3 v(9, 9, 9);
      EXPECT_TRUE(camera.unproject(q, v).ok());
      return v;
    };
    const Mat32 J = numeric_jacobian<3, 2>(f, px, 1e-3);
    EXPECT_LT((J_px - J).norm(), 1e-5 * J.norm()) << lens.name << " " << point.transpose();
    EXPECT_LT((bearing.transpose() * J_px).norm(), 1e-13 * J.norm()) << lens.name;
  });
}

TEST(CameraJacobian, UnprojectTimesProject_IsIdentityOnPixels) {
  for_each_point([](const test::Lens& lens, const Camera& camera, const Vec3& point) {
    Vec2 px;
    Vec3 bearing;
    Mat32 J_px;
    ProjectJacobians jacobians;
    ASSERT_TRUE(camera.project(point.normalized(), px, &jacobians).ok());
    ASSERT_TRUE(camera.unproject(px, bearing, &J_px).ok());
    EXPECT_LT((jacobians.J_point * J_px - Mat22::Identity()).norm(), 1e-9) << lens.name << " " << point.transpose();
  });
}

}  // namespace
}  // namespace roomcal::camera
