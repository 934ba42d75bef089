#include "runtime/camera/camera.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/runtime/camera/lenses.h"

namespace roomcal::camera {
namespace {

using test::bearing_at;
using test::kFieldFractions;
using test::kLenses;
using test::make_camera;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

// Angle between unit vectors, good to rounding also for tiny angles.
double angle_between_rad(const Vec3& a, const Vec3& b) { return 2 * std::asin(0.5 * (a - b).norm()); }

template <typename F>
void for_each_bearing(const Camera& camera, const F& f) {
  for (const double fraction : kFieldFractions)
    for (int i = 0; i < 36; ++i) f(bearing_at(fraction * camera.max_angle_rad(), 0.1 + deg_to_rad(10.0 * i)));
}

TEST(Camera, ProjectThenUnproject_ReturnsTheBearing) {
  for (const auto& lens : kLenses) {
    const Camera camera = make_camera(lens);
    for_each_bearing(camera, [&](const Vec3& bearing) {
      Vec2 px;
      Vec3 back;
      ASSERT_TRUE(camera.project(2.5 * bearing, px).ok()) << lens.name;
      ASSERT_TRUE(camera.unproject(px, back).ok()) << lens.name << " " << px.transpose();
      EXPECT_NEAR(back.norm(), 1, 1e-15);
      // A pixel far from the corner is rounded to 1e-13 of itself, and at the edge of a folding field the slope is
      // 1e-3 by definition: what a double can hold, not what the iteration leaves.
      EXPECT_LT(angle_between_rad(back, bearing), 2e-12) << lens.name << " " << bearing.transpose();
    });
  }
}

TEST(Camera, UnprojectThenProject_ReturnsThePixelOverTheWholeField) {
  for (const auto& lens : kLenses) {
    const Camera camera = make_camera(lens);
    for_each_bearing(camera, [&](const Vec3& bearing) {
      Vec2 px, again_px;
      Vec3 back;
      ASSERT_TRUE(camera.project(bearing, px).ok());
      ASSERT_TRUE(camera.unproject(px, back).ok()) << lens.name;
      ASSERT_TRUE(camera.project(back, again_px).ok()) << lens.name << " " << bearing.transpose();
      EXPECT_LT((again_px - px).norm(), 1e-9) << lens.name << " " << px.transpose();
    });
  }
}

TEST(Camera, EveryPixelOfTheImage_RoundTripsOrIsRefused) {
  for (const auto& lens : kLenses) {
    const Camera camera = make_camera(lens);
    int inside = 0;
    for (int y = 0; y <= 40; ++y) {
      for (int x = 0; x <= 40; ++x) {
        const Vec2 px(lens.intrinsics.width_px * x / 40.0 - 0.5, lens.intrinsics.height_px * y / 40.0 - 0.5);
        Vec3 bearing;
        const Status status = camera.unproject(px, bearing);
        if (!status.ok()) {
          EXPECT_EQ(status.code(), StatusCode::kOutOfRange);
          continue;
        }
        ++inside;
        Vec2 back_px;
        ASSERT_TRUE(camera.project(bearing, back_px).ok()) << lens.name << " " << px.transpose();
        EXPECT_LT((back_px - px).norm(), 1e-9) << lens.name << " " << px.transpose();
      }
    }
    // The folding lens draws a circle of half the image; all others fill theirs.
    if (&lens == &kLenses[9])
      EXPECT_NEAR(inside, 885, 100) << lens.name;
    else
      EXPECT_EQ(inside, 41 * 41) << lens.name;
  }
}

TEST(Camera, JustInsideAndOutsideTheField_IsAcceptedAndRefused) {
  for (const auto& lens : kLenses) {
    const Camera camera = make_camera(lens);
    for (int i = 0; i < 12; ++i) {
      Vec2 px(-7, -8);
      const double azimuth_rad = deg_to_rad(30.0 * i);
      EXPECT_TRUE(camera.project(bearing_at(camera.max_angle_rad() - 1e-12, azimuth_rad), px).ok()) << lens.name;
      px = {-7, -8};
      ProjectJacobians jacobians;
      jacobians.J_point.setConstant(3);
      const Vec3 outside = bearing_at(camera.max_angle_rad() + 1e-9, azimuth_rad);
      EXPECT_EQ(camera.project(outside, px, &jacobians).code(), StatusCode::kOutOfRange) << lens.name;
      EXPECT_EQ(px, Vec2(-7, -8));
      EXPECT_EQ(jacobians.J_point, Mat23::Constant(3));
    }
  }
}

TEST(Camera, PixelBeyondTheField_IsRefusedAndLeavesTheOutputs) {
  for (const auto& lens : kLenses) {
    const Camera camera = make_camera(lens);
    for (int i = 0; i < 24; ++i) {
      const double azimuth_rad = deg_to_rad(15.0 * i);
      Vec2 edge_px;
      ASSERT_TRUE(camera.project(bearing_at(camera.max_angle_rad() * (1 - 1e-12), azimuth_rad), edge_px).ok());
      const Vec2 principal_px(lens.intrinsics.cx_px, lens.intrinsics.cy_px);
      const Vec2 outside_px = principal_px + 1.05 * (edge_px - principal_px);
      Vec3 bearing(1, 2, 3);
      Mat32 J = Mat32::Constant(4);
      EXPECT_EQ(camera.unproject(outside_px, bearing, &J).code(), StatusCode::kOutOfRange) << lens.name;
      EXPECT_EQ(bearing, Vec3(1, 2, 3));
      EXPECT_EQ(J, Mat32::Constant(4));
    }
  }
}

TEST(Camera, PointBehindAPinhole_IsOutOfRange) {
  const Camera camera = make_camera(kLenses[1]);
  Vec2 px(1, 1);
  EXPECT_EQ(camera.project({0, 0, -1}, px).code(), StatusCode::kOutOfRange);
  EXPECT_EQ(camera.project({0.1, 0, 0}, px).code(), StatusCode::kOutOfRange);
  EXPECT_EQ(camera.project({0, 0, 0}, px).code(), StatusCode::kOutOfRange);
  EXPECT_EQ(px, Vec2(1, 1));
}

TEST(Camera, FisheyeBeyond180Degrees_SeesPointsBehindItsPlane) {
  const Camera camera = make_camera(kLenses[8]);
  Vec2 px;
  Vec3 bearing;
  const Vec3 behind = bearing_at(deg_to_rad(109), 0.4);
  ASSERT_LT(behind.z(), 0);
  ASSERT_TRUE(camera.project(behind, px).ok());
  ASSERT_TRUE(camera.unproject(px, bearing).ok());
  EXPECT_LT(angle_between_rad(bearing, behind), 1e-14);
  EXPECT_EQ(camera.project({0, 0, -1}, px).code(), StatusCode::kOutOfRange);
}

TEST(Camera, LengthOfThePoint_DoesNotMatter) {
  for (const auto& lens : kLenses) {
    const Camera camera = make_camera(lens);
    Vec2 near_px, far_px;
    ASSERT_TRUE(camera.project(1e-6 * Vec3(0.2, -0.1, 1), near_px).ok());
    ASSERT_TRUE(camera.project(1e9 * Vec3(0.2, -0.1, 1), far_px).ok());
    EXPECT_LT((near_px - far_px).norm(), 1e-11);
  }
}

TEST(Camera, NotANumber_IsInvalidAndLeavesTheOutputs) {
  for (const auto& lens : kLenses) {
    const Camera camera = make_camera(lens);
    for (const double bad : {kNaN, kInf, -kInf}) {
      for (int i = 0; i < 3; ++i) {
        Vec3 point(0.1, 0.2, 1);
        point[i] = bad;
        Vec2 px(5, 6);
        EXPECT_EQ(camera.project(point, px).code(), StatusCode::kInvalidArgument);
        EXPECT_EQ(px, Vec2(5, 6));
      }
      Vec3 bearing(1, 2, 3);
      EXPECT_EQ(camera.unproject({bad, 4}, bearing).code(), StatusCode::kInvalidArgument);
      EXPECT_EQ(camera.unproject({4, bad}, bearing).code(), StatusCode::kInvalidArgument);
      EXPECT_EQ(bearing, Vec3(1, 2, 3));
    }
  }
}

TEST(Camera, UselessParameters_AreRefused) {
  const auto code_of = [](auto&& change) {
    Intrinsics intrinsics = kLenses[1].intrinsics;
    change(intrinsics);
    return Camera::create(intrinsics).status().code();
  };
  const StatusCode invalid = StatusCode::kInvalidArgument;
  EXPECT_EQ(code_of([](Intrinsics&) {}), StatusCode::kOk);
  EXPECT_EQ(code_of([](Intrinsics& i) { i.fx_px = kNaN; }), invalid);
  EXPECT_EQ(code_of([](Intrinsics& i) { i.cy_px = kInf; }), invalid);
  EXPECT_EQ(code_of([](Intrinsics& i) { i.distortion[3] = kNaN; }), invalid);
  EXPECT_EQ(code_of([](Intrinsics& i) { i.fy_px = 0; }), invalid);
  EXPECT_EQ(code_of([](Intrinsics& i) { i.fx_px = -1700; }), invalid);
  EXPECT_EQ(code_of([](Intrinsics& i) { i.width_px = 0; }), invalid);
  EXPECT_EQ(code_of([](Intrinsics& i) { i.height_px = -1; }), invalid);
  EXPECT_EQ(code_of([](Intrinsics& i) { i.distortion[0] = -1e6; }), invalid);
  EXPECT_EQ(code_of([](Intrinsics& i) { i.distortion[2] = 1e5; }), invalid);
}

}  // namespace
}  // namespace roomcal::camera
