#include "tools/device/nominal.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

using nlohmann::json;
using test::contains;
using test::refusal;

Device two_cameras() {
  Device device;
  device.name = "rig";
  device.rig_frame = "cam0";
  for (const char* name : {"cam0", "cam1"}) {
    Sensor sensor;
    sensor.name = name;
    sensor.intrinsics = {camera::Model::kPinholeRadtan, 640, 480, 500, 500, 320, 240, {}};
    device.sensors.push_back(sensor);
  }
  return device;
}

json rows(const SE3& T) {
  json result = json::array();
  const Mat44 m = T.matrix();
  for (int r = 0; r < 4; ++r) result.push_back({m(r, 0), m(r, 1), m(r, 2), m(r, 3)});
  return result;
}

SE3 some_pose(double a) {
  Vec6 xi;
  xi << 0.1 * a, -0.2, 0.05 * a, 0.3, -0.1 * a, 0.2 * a;
  return se3_exp(xi);
}

/// cam0 -> cam1 by one edge; lidar0 hangs on cam1, given the other way round.
json nominal(const SE3& T_cam0_cam1, const SE3& T_cam1_lidar0) {
  return {{"device", "stereo"},
          {"cameras", {"cam0", "cam1"}},
          {"lidars", {{{"name", "lidar0"}, {"kind", "vlp16"}, {"file", "lidar0.pcap"}}}},
          {"sigma_rot_deg_per_axis", 1.0},
          {"sigma_t_m_per_axis", 0.008},
          {"edges",
           {{{"to", "cam1"}, {"from", "cam0"}, {"T", rows(T_cam0_cam1.inverse())}},
            {{"to", "cam1"}, {"from", "lidar0"}, {"T", rows(T_cam1_lidar0)}}}}};
}

TEST(ApplyNominal, EdgesOfEitherDirection_Compose) {
  const SE3 T_cam0_cam1 = some_pose(1), T_cam1_lidar0 = some_pose(-2);
  Device device = two_cameras();
  apply_nominal("n.json", nominal(T_cam0_cam1, T_cam1_lidar0).dump(), device);
  EXPECT_EQ(device.name, "stereo");
  ASSERT_EQ(device.sensors.size(), 3U);
  EXPECT_FALSE(device.sensors[0].nominal);
  const NominalMount& cam1 = *device.sensors[1].nominal;
  const NominalMount& lidar0 = *device.sensors[2].nominal;
  EXPECT_LT((cam1.T_rig_sensor.matrix() - T_cam0_cam1.matrix()).norm(), 1e-9);
  EXPECT_LT((lidar0.T_rig_sensor.matrix() - (T_cam0_cam1 * T_cam1_lidar0).matrix()).norm(), 1e-9);
  EXPECT_NEAR(cam1.sigma_t_m, 0.008, 1e-15);
  EXPECT_NEAR(lidar0.sigma_t_m, 0.008 * std::sqrt(2.0), 1e-15) << "two edges";
  EXPECT_EQ(device.sensors[2].lidar_model, "vlp16");
  EXPECT_EQ(device.sensors[2].file, "lidar0.pcap");
}

TEST(ApplyNominal, SeveralWays_TheShortestCounts) {
  json file = nominal(some_pose(1), some_pose(2));
  file["edges"].push_back({{"to", "cam0"}, {"from", "lidar0"}, {"T", rows(some_pose(5))}});
  Device device = two_cameras();
  apply_nominal("n.json", file.dump(), device);
  EXPECT_LT((device.sensors[2].nominal->T_rig_sensor.matrix() - some_pose(5).matrix()).norm(), 1e-9);
}

TEST(ApplyNominal, EveryBadInput_NamesTheThing) {
  struct Bad {
    std::string expected;
    std::function<void(json&)> apply;
  };
  for (const Bad& bad : std::vector<Bad>{
           {"n.json: edges[0].T: expected a finite number", [](json& j) { j["edges"][0]["T"][1][2] = nullptr; }},
           {"n.json: edges[0].T: expected a finite number", [](json& j) { j["edges"][0]["T"][1][2] = "1"; }},
           {"n.json: edges[0].T: not a rigid transform", [](json& j) { j["edges"][0]["T"][0][0] = 3; }},
           {"n.json: edges[0].T: expected four rows", [](json& j) { j["edges"][0]["T"].erase(3); }},
           {"n.json: edges[1]: `T` is missing", [](json& j) { j["edges"][1].erase("T"); }},
           {"n.json: edges[1]: no sensor `lidar7`", [](json& j) { j["edges"][1]["from"] = "lidar7"; }},
           {"n.json: edges: none connects `lidar0`", [](json& j) { j["edges"].erase(1); }},
           {"n.json: nominal: `edges` is missing", [](json& j) { j.erase("edges"); }},
           {"n.json: nominal.edges: expected a list", [](json& j) { j["edges"] = 3; }},
           {"n.json: cameras: `cam5` is not in the camchain", [](json& j) { j["cameras"].push_back("cam5"); }},
           {"n.json: nominal: `sigma_t_m_per_axis` is missing", [](json& j) { j.erase("sigma_t_m_per_axis"); }},
           {"n.json: cam1: sigma_t_m must be between", [](json& j) { j["sigma_t_m_per_axis"] = -1; }},
           {"n.json: lidars[0]: `kind` is missing", [](json& j) { j["lidars"][0].erase("kind"); }},
           {"n.json: lidars[0]: `cam0` stands already", [](json& j) { j["lidars"][0]["name"] = "cam0"; }},
           {"n.json: expected an object", [](json& j) { j = json::array(); }},
       }) {
    json file = nominal(some_pose(1), some_pose(2));
    bad.apply(file);
    Device device = two_cameras();
    const std::string got = refusal([&] { apply_nominal("n.json", file.dump(), device); });
    EXPECT_TRUE(contains(got, bad.expected)) << "expected: " << bad.expected << "\ngot: " << got;
  }
}

TEST(ApplyNominal, NotJson_IsRefusedWithItsPlace) {
  Device device = two_cameras();
  for (const std::string text : {"", "{", "{\"edges\": [NaN]}", "\xFF\xFE"}) {
    const std::string got = refusal([&] { apply_nominal("n.json", text, device); });
    EXPECT_TRUE(contains(got, "n.json: not JSON") && contains(got, "line 1")) << got;
  }
}

}  // namespace
}  // namespace roomcal::tools
