#include "runtime/scan/observability.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace roomcal::scan {
namespace {

Mat66 information(const Vec6& sigma) { return sigma.cwiseAbs2().cwiseInverse().asDiagonal(); }

TEST(Observability, AllAxesSeen_NothingIsWeak) {
  Vec6 sigma;
  sigma << 5e-4, 5e-4, 5e-4, 1e-4, 1e-4, 1e-4;
  EXPECT_TRUE(find_weak_directions(information(sigma), Mat33::Identity(), {}).empty());
}

TEST(Observability, HeightOpenInATiltedSensor_IsNamedInTheRoom) {
  const Mat33 R = so3_exp(Vec3(0.7, 0.2, 0.4));
  // 140 mm along the room's z, half a millimetre across, in the sensor's frame.
  Vec3 variance(2.5e-7, 2.5e-7, 0.14 * 0.14);
  Mat66 cov = Mat66::Identity() * 1e-8;
  cov.topLeftCorner<3, 3>() = R.transpose() * variance.asDiagonal() * R;
  const WeakDirections weak = find_weak_directions(cov.inverse(), R, {});
  ASSERT_EQ(weak.size(), 1U);
  EXPECT_FALSE(weak[0].rotation);
  EXPECT_NEAR(std::abs(weak[0].axis_room.z()), 1, 1e-3);
  EXPECT_NEAR(weak[0].sigma, 0.14, 0.005);  // the cap of 1 m takes a little
  EXPECT_EQ(describe({false, Vec3::UnitZ(), 0.14}).view(), "height not seen, 1-sigma 140 mm");
}

TEST(Observability, NoInformation_SixWeakAxesAtTheCap) {
  const WeakDirections weak = find_weak_directions(Mat66::Zero(), Mat33::Identity(), {});
  ASSERT_EQ(weak.size(), 6U);
  EXPECT_NEAR(weak[0].sigma, kUnseenSigma_m, 1e-9);
  EXPECT_NEAR(weak[5].sigma, kUnseenSigma_rad, 1e-9);
}

TEST(Describe, Axes_GoByTheirNames) {
  EXPECT_EQ(describe({true, -Vec3::UnitZ(), deg_to_rad(0.03)}).view(), "heading weakly seen, 1-sigma 0.03 deg");
  EXPECT_EQ(describe({false, Vec3::UnitX(), 0.002}).view(), "position along x weakly seen, 1-sigma 2 mm");
  EXPECT_EQ(describe({true, Vec3::UnitY(), 0.4}).view(), "tilt about y not seen, 1-sigma 23 deg");
}

}  // namespace
}  // namespace roomcal::scan
