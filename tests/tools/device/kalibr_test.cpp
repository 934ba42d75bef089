#include "tools/device/kalibr.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

using test::contains;
using test::refusal;

std::string camera(const std::string& name, const std::string& more = "") {
  return name +
         ":\n  camera_model: pinhole\n  distortion_model: radtan\n  distortion_coeffs: [-0.1, 0.1, 0.0003, -0.0003]\n" +
         "  intrinsics: [1740.7, 1740.9, 641.8, 501.3]\n  resolution: [1280, 1024]\n  rostopic: /" + name +
         "/image_raw\n" + more;
}

std::string shifted(double x_m) {
  return "  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, " + std::to_string(x_m) +
         "]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.0, 0.0, 1.0, 0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(ParseKalibr, BothModels_AreRead) {
  const Device device = parse_kalibr("c.yaml", camera("cam0") + replaced(camera("cam1"), "radtan", "equidistant"));
  ASSERT_EQ(device.sensors.size(), 2U);
  EXPECT_EQ(device.rig_frame, "cam0");
  EXPECT_EQ(device.sensors[0].intrinsics.model, camera::Model::kPinholeRadtan);
  EXPECT_EQ(device.sensors[1].intrinsics.model, camera::Model::kKannalaBrandt);
  EXPECT_EQ(device.sensors[0].intrinsics.fy_px, 1740.9);
  EXPECT_EQ(device.sensors[0].intrinsics.height_px, 1024);
  EXPECT_EQ(device.sensors[0].intrinsics.distortion[2], 0.0003);
  EXPECT_FALSE(device.sensors[1].nominal);
}

TEST(ParseKalibr, NoDistortion_IsZero) {
  const std::string text = replaced(camera("cam0"), "radtan\n  distortion_coeffs: [-0.1, 0.1, 0.0003, -0.0003]",
                                    "none\n  distortion_coeffs: []");
  EXPECT_EQ(parse_kalibr("c.yaml", text).sensors[0].intrinsics.distortion[0], 0);
}

// T_cn_cnm1 maps points of the camera before: cam1 with +0.1 in x sits at -0.1 in cam0's frame.
TEST(ParseKalibr, Chain_BecomesNominalMounts) {
  const Device device =
      parse_kalibr("c.yaml", camera("cam0") + camera("cam1", shifted(0.1)) + camera("cam2", shifted(0.2)));
  ASSERT_TRUE(device.sensors[1].nominal && device.sensors[2].nominal);
  EXPECT_LT((device.sensors[1].nominal->T_rig_sensor.t - Vec3(-0.1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((device.sensors[2].nominal->T_rig_sensor.t - Vec3(-0.3, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(device.sensors[2].nominal->sigma_t_m, std::sqrt(2.0) * kChainSigma_t_m, 1e-15);
}

TEST(ParseKalibr, ChainWithAGap_GivesNoMountBehindIt) {
  const Device device = parse_kalibr("c.yaml", camera("cam0") + camera("cam1") + camera("cam2", shifted(0.2)));
  EXPECT_FALSE(device.sensors[1].nominal);
  EXPECT_FALSE(device.sensors[2].nominal);
}

TEST(ParseKalibr, EveryBadInput_NamesTheThing) {
  struct Bad {
    std::string text, expected;
  };
  const std::string good = camera("cam0");
  for (const Bad& bad : std::vector<Bad>{
           {"", "c.yaml: empty"},
           {"{}", "no cameras"},
           {"cam0: 3\n", "c.yaml:1: cam0: expected the keys of a Kalibr camera"},
           {replaced(good, "pinhole", "omni"), "c.yaml:2: cam0: camera_model `omni` is not supported"},
           {replaced(good, "pinhole", "ds"), "c.yaml:2: cam0: camera_model `ds` is not supported"},
           {replaced(good, "radtan", "fov"), "c.yaml:3: cam0: distortion_model `fov` is not supported"},
           {replaced(good, "[-0.1, ", "[.nan, "), "c.yaml:4: cam0: distortion_coeffs: expected a finite"},
           {replaced(good, "[-0.1, ", "["), "c.yaml:4: cam0: distortion_coeffs: expected a list of 4"},
           {replaced(good, "1740.7", "inf"), "c.yaml:5: cam0: intrinsics: expected a finite"},
           {replaced(good, "1740.7", "0"), "cam0: invalid argument"},
           {replaced(good, "1280", "-1280"), "cam0: invalid argument"},
           {replaced(good, "resolution", "size"), "`resolution` is missing"},
           {good + camera("cam1", replaced(shifted(0.1), "[1.0", "[1.2")), "cam1: T_cn_cnm1: the upper left 3x3"},
           {good + good, "two sensors have this name"},
       }) {
    const std::string got = refusal([&] { static_cast<void>(parse_kalibr("c.yaml", bad.text)); });
    EXPECT_TRUE(contains(got, bad.expected)) << "expected: " << bad.expected << "\ngot: " << got;
  }
}

}  // namespace
}  // namespace roomcal::tools
