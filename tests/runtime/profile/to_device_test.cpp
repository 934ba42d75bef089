#include <memory>

#include <gtest/gtest.h>

#include "runtime/calib/lidar_models.h"
#include "runtime/profile/profile.h"
#include "tests/runtime/profile/sample_profile.h"

namespace roomcal::profile {
namespace {

TEST(ToDevice, FullProfile_KeepsOrderNamesAndNumbers) {
  const Profile profile = test::full_profile();
  const auto device = std::make_unique<calib::Device>();
  static_cast<void>(device->cameras.push_back({}));  // from before: overwritten
  ASSERT_TRUE(to_device(profile, *device).ok());
  ASSERT_EQ(device->cameras.size(), 3U);
  ASSERT_EQ(device->lidars.size(), 3U);
  EXPECT_EQ(device->reference, 1U);
  for (std::size_t i = 0; i < 3; ++i) {
    const calib::CameraSpec& camera = device->cameras[i];
    EXPECT_EQ(camera.name.view(), profile.cameras[i].name.view());
    EXPECT_EQ(camera.serial.view(), profile.cameras[i].serial.view());
    EXPECT_EQ(camera.sigma_px, 0.15);
    EXPECT_EQ(camera.camera.intrinsics().fx_px, profile.cameras[i].intrinsics.fx_px);
    EXPECT_EQ(camera.camera.intrinsics().model, profile.cameras[i].intrinsics.model);
    EXPECT_EQ(camera.nominal.known, i != 1);
  }
  EXPECT_EQ(device->cameras[2].nominal.T_rig_sensor.t, profile.cameras[2].nominal.T_rig_sensor.t);
  const calib::LidarSpec& ouster = device->lidars[1];
  EXPECT_EQ(ouster.name.view(), "lidar1");
  EXPECT_EQ(ouster.model.view(), "os1");
  EXPECT_EQ(ouster.serial.view(), "L-7502");
  EXPECT_EQ(ouster.ranges.max_range_m, calib::ranges_of("os1")->max_range_m);
  EXPECT_TRUE(ouster.nominal.known);
}

TEST(ToDevice, IntrinsicsThatAreNone_AreInvalidArgument) {
  Profile profile = test::full_profile();
  profile.cameras[2].intrinsics.fy_px = -1;
  const auto device = std::make_unique<calib::Device>();
  EXPECT_EQ(to_device(profile, *device).code(), StatusCode::kInvalidArgument);
}

TEST(ToDevice, LidarModelThatIsNone_IsInvalidArgument) {
  Profile profile = test::full_profile();
  profile.lidars[1].model = "os9";
  const auto device = std::make_unique<calib::Device>();
  EXPECT_EQ(to_device(profile, *device).code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace roomcal::profile
