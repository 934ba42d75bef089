#include "runtime/camera/kannala_brandt.h"

#include <gtest/gtest.h>

#include "runtime/camera/field_limit.h"
#include "tests/runtime/camera/lenses.h"

namespace roomcal::camera {
namespace {

constexpr double kFar = 1e3;

TEST(KannalaBrandt, EquidistantLens_ReachesAlmostToStraightBehind) {
  const KannalaBrandt lens{};
  EXPECT_NEAR(lens.max_angle_rad(kFar), kPi, 1.01e-4);
  EXPECT_LT(lens.max_angle_rad(kFar), kPi);
}

TEST(KannalaBrandt, Fold_LimitsTheField) {
  // Slope 1 + 3 k1 theta^2 is zero at theta = 1.
  const KannalaBrandt lens{{-1.0 / 3, 0, 0, 0}};
  EXPECT_NEAR(lens.max_angle_rad(kFar), std::sqrt(1 - kMinSlope), 1e-12);
}

TEST(KannalaBrandt, SlopeOverTheField_StaysAboveItsMinimum) {
  for (const auto& lens : test::kLenses) {
    if (lens.intrinsics.model != Model::kKannalaBrandt) continue;
    const KannalaBrandt model = KannalaBrandt::from(lens.intrinsics);
    const double limit_rad = model.max_angle_rad(kFar);
    for (int i = 0; i <= 10000; ++i) EXPECT_GE(model.radius(limit_rad * i / 10000).slope, kMinSlope * (1 - 1e-9));
  }
}

TEST(KannalaBrandt, ReachInThePlane_LimitsTheField) {
  const KannalaBrandt lens{{0.5, 0, 0, 0}};
  EXPECT_NEAR(lens.radius(lens.max_angle_rad(2.0)).value, 2.0, 1e-12);
}

TEST(KannalaBrandt, AngleOfRadius_InvertsToRounding) {
  for (const auto& lens : test::kLenses) {
    if (lens.intrinsics.model != Model::kKannalaBrandt) continue;
    const KannalaBrandt model = KannalaBrandt::from(lens.intrinsics);
    const double limit_rad = model.max_angle_rad(kFar);
    for (int i = 0; i <= 2000; ++i) {
      const double r = model.radius(limit_rad * i / 2000).value;
      EXPECT_NEAR(model.radius(model.angle_rad(r, limit_rad)).value, r, 1e-15 * (1 + r)) << lens.name;
    }
  }
}

TEST(KannalaBrandt, RadiusBeyondTheField_HasNoAngle) {
  const KannalaBrandt lens{{-1.0 / 3, 0, 0, 0}};
  EXPECT_LT(lens.angle_rad(0.7, lens.max_angle_rad(kFar)), 0);
}

}  // namespace
}  // namespace roomcal::camera
