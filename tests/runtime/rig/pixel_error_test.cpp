#include "runtime/rig/pixel_error.h"

#include <cmath>

#include <gtest/gtest.h>

namespace roomcal::rig {
namespace {

camera::Camera pinhole() {
  return camera::Camera::create({camera::Model::kPinholeRadtan, 640, 480, 500, 500, 319.5, 239.5, {}}).value();
}

TEST(PixelError, SidewaysSigma_FallsWithTheDistance) {
  Mat66 cov = Mat66::Zero();
  cov(0, 0) = 1e-6;  // 1 mm along x of the sensor, which is the camera's
  EXPECT_NEAR(predicted_pixel_error(pinhole(), SE3(), cov, 1), 0.5, 0.2);  // f * 1 mm / 1 m, more towards the corners
  EXPECT_NEAR(predicted_pixel_error(pinhole(), SE3(), cov, 2) / predicted_pixel_error(pinhole(), SE3(), cov, 1), 0.5,
              1e-9);
}

TEST(PixelError, Rotation_IsTheSameAtEveryDistance) {
  Mat66 cov = Mat66::Zero();
  cov(4, 4) = 1e-6;  // 1 mrad about y
  const double near_px = predicted_pixel_error(pinhole(), SE3(), cov, 1);
  EXPECT_GT(near_px, 0.5);
  EXPECT_NEAR(predicted_pixel_error(pinhole(), SE3(), cov, 10), near_px, 1e-9);
}

TEST(PixelError, TurnedSensor_MovesAlongItsOwnAxes) {
  Mat66 cov = Mat66::Zero();
  cov(2, 2) = 1e-6;  // along the sensor's z, which lies along the camera's x
  const SE3 T_cam_b{so3_exp(0.5 * kPi * Vec3::UnitY()), Vec3::Zero()};
  Mat66 along_x = Mat66::Zero();
  along_x(0, 0) = 1e-6;
  EXPECT_NEAR(predicted_pixel_error(pinhole(), T_cam_b, cov, 3), predicted_pixel_error(pinhole(), SE3(), along_x, 3),
              1e-9);
}

}  // namespace
}  // namespace roomcal::rig
