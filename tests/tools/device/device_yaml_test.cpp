#include "tools/device/device_yaml.h"

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

using test::contains;
using test::refusal;

const char* const kRobot = R"(version: 1
name: robot
rig_frame: cam0
sensors:
  - name: cam0
    kind: camera
    model: kannala_brandt
    resolution_px: [1280, 720]
    intrinsics_px: [612.2, 612.4, 634.9, 362.0]
    distortion: [-0.019, 0.0045, -0.0018, 0.0003]
  - name: cam1
    kind: camera
    model: pinhole_radtan
    resolution_px: [1280, 1024]
    intrinsics_px: [1740.7, 1740.9, 641.8, 501.3]
    distortion: [-0.116, 0.109, 0.0004, -0.0003]
    sigma_px: 0.15
    intrinsics_sigma: {focal_px: 2.5, distortion_px: 0}
    nominal:
      T_rig_sensor: [[0, 0, 1, 0.1], [0, 1, 0, -0.02], [-1, 0, 0, 0.003], [0, 0, 0, 1]]
      sigma_t_m: 0.008
      sigma_rot_deg: 1
  - name: lidar0
    kind: lidar
    model: vlp16
    file: lidar0.pcap
)";

/// The robot with the first `from` replaced by `to`.
std::string robot_with(const std::string& from, const std::string& to) {
  std::string text = kRobot;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(ParseDeviceYaml, EveryField_IsRead) {
  const Device device = parse_device_yaml("d.yaml", kRobot);
  EXPECT_EQ(device.name, "robot");
  EXPECT_EQ(device.rig_frame, "cam0");
  ASSERT_EQ(device.sensors.size(), 3U);
  const Sensor& cam1 = device.sensors[1];
  EXPECT_EQ(device.sensors[0].intrinsics.model, camera::Model::kKannalaBrandt);
  EXPECT_EQ(cam1.intrinsics.model, camera::Model::kPinholeRadtan);
  EXPECT_EQ(cam1.intrinsics.width_px, 1280);
  EXPECT_EQ(cam1.intrinsics.height_px, 1024);
  EXPECT_EQ(cam1.intrinsics.fx_px, 1740.7);
  EXPECT_EQ(cam1.intrinsics.cy_px, 501.3);
  EXPECT_EQ(cam1.intrinsics.distortion[3], -0.0003);
  EXPECT_EQ(cam1.sigma_px, 0.15);
  EXPECT_EQ(device.sensors[0].sigma_px, 0);
  EXPECT_FALSE(device.sensors[0].intrinsics_sigma);
  ASSERT_TRUE(cam1.intrinsics_sigma);
  EXPECT_EQ(cam1.intrinsics_sigma->focal_px, 2.5);
  EXPECT_EQ(cam1.intrinsics_sigma->principal_px, 1);  // what was left out is as usual
  EXPECT_EQ(cam1.intrinsics_sigma->distortion_px, 0);
  ASSERT_TRUE(cam1.nominal);
  EXPECT_EQ(cam1.nominal->T_rig_sensor.t, Vec3(0.1, -0.02, 0.003));
  EXPECT_NEAR(cam1.nominal->T_rig_sensor.R(0, 2), 1, 1e-12);
  EXPECT_EQ(cam1.nominal->sigma_t_m, 0.008);
  EXPECT_NEAR(cam1.nominal->sigma_rot_rad, kPi / 180, 1e-15);
  EXPECT_FALSE(device.sensors[0].nominal);
  EXPECT_EQ(device.sensors[2].kind, SensorKind::kLidar);
  EXPECT_EQ(device.sensors[2].lidar_model, "vlp16");
  EXPECT_EQ(device.sensors[2].file, "lidar0.pcap");
  EXPECT_EQ(device.find("lidar0"), &device.sensors[2]);
  EXPECT_EQ(device.find("cam7"), nullptr);
}

TEST(ToDeviceYaml, ReadBack_IsTheSameTextAgain) {
  const std::string once = to_device_yaml(parse_device_yaml("d.yaml", kRobot));
  EXPECT_EQ(to_device_yaml(parse_device_yaml("d.yaml", once)), once);
}

TEST(ParseDeviceYaml, WithoutLimits_HasTheDefaultsAndWritesNone) {
  const Device device = parse_device_yaml("d.yaml", kRobot);
  EXPECT_EQ(device.limits.max_sigma_t_m, calib::Limits().max_sigma_t_m);
  EXPECT_EQ(to_device_yaml(device).find("limits"), std::string::npos);
}

TEST(ParseDeviceYaml, Limits_AreReadInTheFilesUnitsAndTheOthersStay) {
  const std::string text =
      std::string(kRobot) + "limits:\n  max_sigma_t_m: 0.02\n  max_sigma_rot_deg: 0.5\n  min_inliers: 10\n";
  const Device device = parse_device_yaml("d.yaml", text);
  EXPECT_EQ(device.limits.max_sigma_t_m, 0.02);
  EXPECT_NEAR(device.limits.max_sigma_rot_rad, deg_to_rad(0.5), 1e-15);
  EXPECT_EQ(device.limits.min_inliers, 10U);
  EXPECT_EQ(device.limits.max_chi2_per_dof, calib::Limits().max_chi2_per_dof);
  const std::string once = to_device_yaml(device);
  EXPECT_TRUE(contains(once, "limits:\n  min_inliers: 10\n  max_sigma_t_m: 0.02\n  max_sigma_rot_deg: 0.5"));
  EXPECT_EQ(to_device_yaml(parse_device_yaml("d.yaml", once)), once);
}

TEST(ToDeviceYaml, TextThatYamlWouldTakeForSomethingElse_SurvivesQuoted) {
  Device device = parse_device_yaml("d.yaml", kRobot);
  device.name = "say \"hi\": [a, b] # \\ no";
  EXPECT_EQ(parse_device_yaml("d.yaml", to_device_yaml(device)).name, device.name);
}

TEST(ParseDeviceYaml, EveryBadInput_NamesTheThing) {
  struct Bad {
    std::string text, expected;
  };
  for (const Bad& bad : std::vector<Bad>{
           {"", "d.yaml: empty"},
           {robot_with("version: 1", "version: 2"), "d.yaml:1: version: this roomcal reads version 1"},
           {robot_with("version: 1\n", ""), "`version` is missing"},
           {robot_with("rig_frame", "rig_fram"), "d.yaml:3: device: unknown key `rig_fram`"},
           {robot_with("rig_frame: cam0", "rig_frame: cam9"), "rig_frame `cam9` is none of the sensors"},
           {robot_with("612.2", ".nan"), "d.yaml:9: cam0: intrinsics_px: expected a finite number, got `.nan`"},
           {robot_with("612.2", "-612.2"), "cam0: invalid argument"},
           {robot_with("612.2, ", ""), "d.yaml:9: cam0: intrinsics_px: expected a list of 4"},
           {robot_with("1280, 720", "1280.5, 720"), "d.yaml:8: cam0: resolution_px: expected a whole number"},
           {robot_with("1280, 720", "0, 720"), "cam0: invalid argument"},
           {robot_with(", 0.0003", ""), "d.yaml:10: cam0: distortion: expected a list of 4"},
           {robot_with("sigma_px: 0.15", "sigma_px: -1"), "cam1: sigma_px is what the intrinsics leave"},
           {robot_with("focal_px: 2.5", "focal: 2.5"), "cam1: intrinsics_sigma: unknown key `focal`"},
           {robot_with("focal_px: 2.5", "focal_px: -1"),
            "cam1: intrinsics_sigma: focal_px must be between 0 and 87 px"},
           {robot_with("kannala_brandt", "omni"), "d.yaml:7: cam0: model `omni` is not supported"},
           {robot_with("kind: lidar", "kind: radar"), "lidar0: kind `radar`; known are camera and lidar"},
           {robot_with("    distortion", "    distorsion"), "d.yaml:10: cam0: unknown key `distorsion`"},
           {robot_with("name: cam1", "name: cam0"), "cam0: two sensors have this name"},
           {robot_with("name: cam1", "name: cam 1"), "sensor name `cam 1`"},
           {robot_with("name: cam1", "name: ../cam"), "sensor name `../cam`"},
           {robot_with("name: cam1", "name: " + std::string(32, 'x')), "sensor name `xxx"},
           {robot_with("[0, 0, 0, 1]", "[0, 0, 0, 0]"), "cam1: nominal: T_rig_sensor: the last row"},
           {robot_with("[[0, 0, 1, 0.1]", "[[0, 0, 1.1, 0.1]"), "cam1: nominal: T_rig_sensor: the upper left 3x3"},
           {robot_with("[[0, 0, 1, 0.1]", "[[0, 0, 1, nan]"), "cam1: nominal: T_rig_sensor: expected a finite"},
           {robot_with("sigma_t_m: 0.008", "sigma_t_m: 0"), "cam1: sigma_t_m must be between"},
           {robot_with("sigma_rot_deg: 1", "sigma_rot_deg: 181"), "cam1: sigma_rot_deg must be between"},
           {robot_with("      sigma_rot_deg: 1\n", ""), "`sigma_rot_deg` is missing"},
           {robot_with("rig_frame: cam0", "rig_frame: cam1"), "cam1 is the rig frame; its T_rig_sensor must be"},
           {"version: 1\nname: a\nrig_frame: b\nsensors: []\n", "no sensors"},
           {"version: 1\nname: a\nrig_frame: b\nsensors: 3\n", "d.yaml:4: sensors: expected a list"},
           {"version: 1\nname: a\nrig_frame: b\nsensors: [3]\n", "d.yaml:4: expected `key: value`"},
           {kRobot + std::string("limits:\n  max_sigma_m: 1\n"), "d.yaml:28: limits: unknown key `max_sigma_m`"},
           {kRobot + std::string("limits:\n  max_sigma_t_m: 0\n"), "limits: max_sigma_t_m must be between 1e-06 and 1"},
           {kRobot + std::string("limits:\n  max_sigma_t_m: .inf\n"), "limits: max_sigma_t_m: expected a finite"},
           {kRobot + std::string("limits:\n  min_inliers: 6.5\n"), "limits: min_inliers: expected a whole number"},
           {kRobot + std::string("limits:\n  min_inliers: 3\n"), "limits: min_inliers must be between 6 and 500"},
           {kRobot + std::string("limits:\n  max_chi2_per_dof: 2\n"),
            "advise_chi2_per_dof must not be above max_chi2_per_dof"},
           {kRobot + std::string("limits: 3\n"), "limits: expected `key: value` lines"},
       }) {
    const std::string got = refusal([&] { static_cast<void>(parse_device_yaml("d.yaml", bad.text)); });
    EXPECT_TRUE(contains(got, bad.expected)) << "expected: " << bad.expected << "\ngot: " << got;
    EXPECT_TRUE(got.starts_with("d.yaml")) << got;
  }
}

}  // namespace
}  // namespace roomcal::tools
