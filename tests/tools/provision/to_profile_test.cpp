#include "tools/provision/to_profile.h"

#include <gtest/gtest.h>

#include "runtime/lidar/model.h"
#include "tests/tools/folder_test.h"
#include "tests/tools/refusal.h"
#include "tools/common/files.h"

namespace roomcal::tools {
namespace {

using test::contains;
using test::refusal;

Sensor camera_named(const std::string& name) {
  Sensor sensor;
  sensor.name = name;
  sensor.intrinsics = {camera::Model::kPinholeRadtan, 640, 480, 400, 401, 320, 240, {-0.1, 0.01, 0, 0}};
  return sensor;
}

Sensor lidar_named(const std::string& name, const std::string& model) {
  Sensor sensor;
  sensor.name = name;
  sensor.kind = SensorKind::kLidar;
  sensor.lidar_model = model;
  return sensor;
}

class ToProfile : public test::FolderTest {
 protected:
  ToProfile() {
    device_.name = "robot";
    device_.serial = "RB-1";
    device_.rig_frame = "cam1";
    device_.sensors = {camera_named("cam0"), lidar_named("lidar0", "vlp16"), camera_named("cam1")};
  }

  profile::Profile profile() const { return to_profile(device_, path("device.yaml")); }
  std::string refusal_of_it() const {
    return refusal([&] { static_cast<void>(profile()); });
  }

  Device device_;
};

TEST_F(ToProfile, Sensors_KeepTheirOrderWithinTheirKind) {
  device_.sensors[0].serial = "S-0";
  device_.sensors[0].sigma_px = 0.2;
  device_.sensors[0].nominal = NominalMount{{Mat33::Identity(), Vec3(1, 2, 3)}, 0.01, 0.02};
  device_.sensors[0].camera_wiring.buffers = 6;
  device_.limits.min_inliers = 10;
  device_.grab.patience_s = 20;
  device_.wiring.replay_folder = "shots";
  const profile::Profile p = profile();
  EXPECT_EQ(p.device.view(), "robot");
  EXPECT_EQ(p.serial.view(), "RB-1");
  ASSERT_EQ(p.cameras.size(), 2U);
  EXPECT_EQ(p.cameras[p.reference].name.view(), "cam1");
  EXPECT_EQ(p.cameras[0].serial.view(), "S-0");
  EXPECT_EQ(p.cameras[0].sigma_px, 0.2);
  EXPECT_EQ(p.cameras[0].intrinsics.fy_px, 401);
  EXPECT_TRUE(p.cameras[0].nominal.known);
  EXPECT_EQ(p.cameras[0].nominal.T_rig_sensor.t, Vec3(1, 2, 3));
  EXPECT_EQ(p.cameras[0].nominal.sigma_t_m, 0.01);
  EXPECT_EQ(p.cameras[0].nominal.sigma_rot_rad, 0.02);
  EXPECT_EQ(p.cameras[0].wiring.buffers, 6U);
  EXPECT_FALSE(p.cameras[1].nominal.known);
  EXPECT_EQ(p.limits.min_inliers, 10U);
  EXPECT_EQ(p.grab.patience_s, 20);
  EXPECT_EQ(p.wiring.replay_folder.view(), "shots");
}

TEST_F(ToProfile, LidarWithoutFile_HasTheManualsAnglesAndItsUsualPort) {
  const profile::Profile p = profile();
  ASSERT_EQ(p.lidars.size(), 1U);
  EXPECT_EQ(p.lidars[0].calibration.beam_count, 16U);
  EXPECT_FALSE(p.lidars[0].calibration.from_unit);
  EXPECT_EQ(p.lidars[0].wiring.port, 2368U);
  device_.sensors[1].lidar_wiring.port = 2400;
  EXPECT_EQ(profile().lidars[0].wiring.port, 2400U);
}

TEST_F(ToProfile, LidarsAnglesFile_LiesBesideTheDevice) {
  std::string csv = "Laser id,Elevation,Azimuth\n";
  for (int i = 1; i <= 16; ++i) csv += std::to_string(i) + "," + std::to_string(16 - 2 * i) + ",0.5\n";
  write_atomic(path("angles.csv"), csv);
  device_.sensors[1] = lidar_named("lidar0", "xt16");
  device_.sensors[1].calibration_file = "angles.csv";
  const profile::Profile p = profile();
  EXPECT_TRUE(p.lidars[0].calibration.from_unit);
  EXPECT_NEAR(p.lidars[0].calibration.beams[0].elevation_rad, deg_to_rad(14.0), 1e-12);
  device_.sensors[1].calibration_file = "other.csv";
  EXPECT_TRUE(contains(refusal_of_it(), "other.csv")) << refusal_of_it();
}

TEST_F(ToProfile, LidarWhoseAnglesOnlyTheUnitKnows_AsksForItsFile) {
  device_.sensors[1] = lidar_named("lidar0", "ouster");
  EXPECT_TRUE(contains(refusal_of_it(), "lidar0: Ouster OS0/OS1/OS2: its angles are the unit's own; name its file"))
      << refusal_of_it();
}

TEST_F(ToProfile, TooMuchForTheRuntime_IsRefusedByName) {
  const std::string file = path("device.yaml").string();
  device_.sensors[1].lidar_model = "vlp17";
  EXPECT_TRUE(contains(refusal_of_it(), file + ": lidar0: LiDAR model 'vlp17' is not known")) << refusal_of_it();

  device_.sensors.erase(device_.sensors.begin() + 1);
  device_.name = std::string(64, 'n');
  EXPECT_EQ(refusal_of_it(), file + ": name: at most 63 characters");
  device_.name = "robot";

  device_.rig_frame = "cam7";
  EXPECT_EQ(refusal_of_it(), file + ": device: the reference sensor is not one of the cameras");
  device_.rig_frame = "cam1";

  device_.sensors[0].camera_wiring.buffers = 1;
  EXPECT_EQ(refusal_of_it(), file + ": cam0: buffers is not between 2 and 16");
  device_.sensors[0].camera_wiring.buffers = 4;

  for (std::size_t i = 2; i <= calib::kMaxCameras; ++i)
    device_.sensors.push_back(camera_named("c" + std::to_string(i)));
  EXPECT_EQ(refusal_of_it(), file + ": more than 8 cameras; split the device");
  device_.sensors.resize(2);
  for (std::size_t i = 0; i <= calib::kMaxLidars; ++i)
    device_.sensors.push_back(lidar_named("l" + std::to_string(i), "vlp16"));
  EXPECT_EQ(refusal_of_it(), file + ": more than 4 LiDARs; split the device");
}

TEST_F(ToProfile, LidarAsTheReference_IsRefused) {
  device_.rig_frame = "lidar0";
  EXPECT_TRUE(contains(refusal_of_it(), "the reference sensor is not one of the cameras"));
}

}  // namespace
}  // namespace roomcal::tools
