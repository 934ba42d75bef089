#include "tools/simulate/imu.h"

#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/simulate/make_room.h"
#include "tools/simulate/stand.h"

namespace roomcal::tools {
namespace {

struct ImuMean {
  Vec3 accel_mps2 = Vec3::Zero(), gyro_radps = Vec3::Zero();
  double accel_squares = 0;
  int samples = 0;
};

ImuMean mean_of(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "stamp_ns,ax_mps2,ay_mps2,az_mps2,gx_radps,gy_radps,gz_radps");
  ImuMean mean;
  long long stamp_ns = 0, last_ns = 0;
  std::vector<Vec3> all;
  while (std::getline(lines, line)) {
    Vec3 a, g;
    EXPECT_EQ(std::sscanf(line.c_str(), "%lld,%lf,%lf,%lf,%lf,%lf,%lf", &stamp_ns, &a.x(), &a.y(), &a.z(), &g.x(),
                          &g.y(), &g.z()),
              7);
    EXPECT_EQ(all.empty() ? 5'000'000 : stamp_ns - last_ns, 5'000'000);
    last_ns = stamp_ns;
    all.push_back(a);
    mean.accel_mps2 += a;
    mean.gyro_radps += g;
  }
  mean.samples = static_cast<int>(all.size());
  mean.accel_mps2 /= mean.samples;
  mean.gyro_radps /= mean.samples;
  for (const Vec3& a : all) mean.accel_squares += (a - mean.accel_mps2).squaredNorm() / (3 * mean.samples);
  return mean;
}

TEST(Imu, AtRest_ShowsGravityItsBiasesAndItsNoise) {
  Random random(4);
  const TrueImu imu = draw_imu({so3_exp(Vec3(0.3, -0.2, 1.1)), Vec3(1, 2, 1)}, random);
  const ImuMean mean = mean_of(imu_csv(imu, 7));
  EXPECT_EQ(mean.samples, 400);
  const Vec3 up_room = imu.T_room_imu.R * (mean.accel_mps2 - imu.accel_bias_mps2);
  EXPECT_LT((up_room - Vec3(0, 0, 9.80665)).norm(), 0.006);
  EXPECT_LT((mean.gyro_radps - imu.gyro_bias_radps).norm(), 0.0006);
  EXPECT_NEAR(std::sqrt(mean.accel_squares), imu.accel_sigma_mps2, 0.0015);
}

TEST(Imu, Mounting_HasItsXAlongTheCamerasLook) {
  const SE3 T_imu_cam = imu_mounting().T_to_from();
  EXPECT_LT((T_imu_cam.R * Vec3::UnitZ() - Vec3::UnitX()).norm(), 1e-12);
  EXPECT_LT((T_imu_cam.R * -Vec3::UnitY() - Vec3::UnitZ()).norm(), 1e-12);
}

TEST(Imu, OnADevice_IsMountedAsAskedAndMovesNothingElse) {
  const Scene scene = make_room({.seed = 2});
  ShotOptions options;
  const Stand without = place_device(scene, device_named("mobile_robot"), options);
  options.imu = true;
  const Stand with = place_device(scene, device_named("mobile_robot"), options);
  EXPECT_FALSE(without.imu);
  ASSERT_TRUE(with.imu);
  EXPECT_EQ(with.lidars[0].T_room_lidar.t, without.lidars[0].T_room_lidar.t);
  const SE3 T_imu_cam = with.imu->T_room_imu.inverse() * with.cameras[0].T_room_cam;
  const Vec6 off = se3_log(imu_mounting().T_to_from().inverse() * T_imu_cam);
  EXPECT_GT(off.norm(), 1e-3);
  EXPECT_LT(off.tail<3>().norm(), deg_to_rad(5));
  EXPECT_GT((with.imu->T_room_imu.R * Vec3::UnitZ()).z(), 0.9);
}

TEST(Imu, OtherSeed_OtherNoise) {
  EXPECT_EQ(imu_csv({}, 3), imu_csv({}, 3));
  EXPECT_NE(imu_csv({}, 3), imu_csv({}, 4));
}

}  // namespace
}  // namespace roomcal::tools
