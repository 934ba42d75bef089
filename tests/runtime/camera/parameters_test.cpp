#include "runtime/camera/parameters.h"

#include <gtest/gtest.h>

#include "tests/runtime/camera/lenses.h"

namespace roomcal::camera {
namespace {

using test::kLenses;
using test::make_camera;

Vec2 project(const Camera& camera, const Vec3& point_cam) {
  Vec2 px(1e9, 1e9);
  EXPECT_TRUE(camera.project(point_cam, px).ok());
  return px;
}

TEST(Parameters, ThereAndBack_IsTheSameCamera) {
  for (const auto& lens : kLenses) {
    Intrinsics other = lens.intrinsics;
    const Parameters p = parameters_of(lens.intrinsics);
    const Intrinsics back = with_parameters(other, p);
    EXPECT_EQ(parameters_of(back), p) << lens.name;
    EXPECT_EQ(back.width_px, lens.intrinsics.width_px);
    EXPECT_EQ(p[1], lens.intrinsics.fy_px);
    EXPECT_EQ(p[7], lens.intrinsics.distortion[3]);
  }
}

TEST(ParameterSigmas, OneSigmaOfEachCoefficient_DisplacesTheCornerByWhatWasSaid) {
  for (const auto& lens : kLenses) {
    const Camera camera = make_camera(lens);
    const Intrinsics& k = lens.intrinsics;
    const Parameters sigma = parameter_sigmas(camera, {2, 1, 0.01});
    EXPECT_EQ(sigma[0], 2);
    EXPECT_EQ(sigma[3], 1);
    const Vec2 corner_px(k.cx_px < 0.5 * k.width_px ? k.width_px - 0.5 : -0.5,
                         k.cy_px < 0.5 * k.height_px ? k.height_px - 0.5 : -0.5);
    Vec3 bearing_cam;
    if (!camera.unproject(corner_px, bearing_cam).ok()) continue;  // a circular image: the field's edge counts
    for (int i = 4; i < kIntrinsicsCount; ++i) {
      Parameters moved = parameters_of(k);
      moved[i] += sigma[i];
      const Camera other = Camera::create(with_parameters(k, moved)).value();
      EXPECT_NEAR((project(other, bearing_cam) - project(camera, bearing_cam)).norm(), 0.01, 1e-5) << lens.name << i;
    }
  }
}

TEST(ParameterSigmas, CornerBeyondTheField_StillGivesFiniteSigmas) {
  for (const auto& lens : kLenses) {
    const Parameters sigma = parameter_sigmas(make_camera(lens), usual_sigma(lens.intrinsics));
    EXPECT_TRUE(sigma.allFinite() && sigma.minCoeff() > 0) << lens.name;
  }
}

TEST(ParameterSigmas, NothingSaid_HoldsEveryParameter) {
  EXPECT_TRUE(parameter_sigmas(make_camera(kLenses[6]), {}).isZero(0));
}

TEST(PixelCovariance, OfTheFocalLength_GrowsAlongTheRadius) {
  const auto& lens = kLenses[0];  // a plain pinhole: px - centre scales with f
  Parameters sigma = Parameters::Zero();
  sigma[0] = 2;
  const Camera camera = make_camera(lens);
  const Vec2 centre(lens.intrinsics.cx_px, lens.intrinsics.cy_px);
  const Mat22 cov = pixel_covariance(camera, sigma, centre + Vec2(174, 50));
  EXPECT_NEAR(std::sqrt(cov(0, 0)), 2 * 174 / lens.intrinsics.fx_px, 1e-9);
  EXPECT_NEAR(cov(1, 1), 0, 1e-12);
  EXPECT_TRUE(pixel_covariance(camera, sigma, Vec2(1e9, 0)).isZero(0));
}

}  // namespace
}  // namespace roomcal::camera
