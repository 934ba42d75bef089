#include "tools/simulate/shot.h"

#include <filesystem>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tools/common/files.h"
#include "tools/simulate/make_room.h"
#include "tools/simulate/shot_files.h"

namespace roomcal::tools {
namespace {

TEST(PlaceDevice, Extrinsics_FollowTheRuleOfTheTruthFile) {
  const Scene scene = make_room({.seed = 2});
  const PaperDevice& device = device_named("backpack");
  const Stand stand = place_device(scene, device, {.seed = 11});
  std::map<std::string, SE3> T_room;
  for (const auto& [name, T_room_sensor] : sensor_poses(stand)) T_room[name] = T_room_sensor;
  ASSERT_EQ(device.edges.size(), 5u);
  for (std::size_t i = 0; i < device.edges.size(); ++i) {
    const SE3 T_to_from = T_room.at(device.edges[i].to).inverse() * T_room.at(device.edges[i].from);
    const SE3 nominal = device.edges[i].T_to_from();
    EXPECT_LT((T_to_from.R - so3_exp(stand.perturbations[i].rotvec_rad) * nominal.R).norm(), 1e-12);
    EXPECT_LT((T_to_from.t - nominal.t - stand.perturbations[i].dt_m).norm(), 1e-12);
  }
}

TEST(PlaceDevice, ManySeeds_DeviceStandsInTheRoomAndIsPerturbedAsAsked) {
  const Scene scene = make_room({.seed = 2, .pillar = true});
  double rot2 = 0, t2 = 0;
  int count = 0;
  for (uint64_t seed = 1; seed <= 200; ++seed) {
    const Stand stand = place_device(scene, device_named("mobile_robot"), {.seed = seed});
    for (const TrueCamera& camera : stand.cameras) {
      for (const Plane& wall : scene.walls) EXPECT_GT(wall.signed_distance(camera.T_room_cam.t), 0.3);
    }
    for (const Perturbation& drawn : stand.perturbations) {
      rot2 += drawn.rotvec_rad.squaredNorm();
      t2 += drawn.dt_m.squaredNorm();
      count += 3;
    }
  }
  EXPECT_NEAR(rad_to_deg(std::sqrt(rot2 / count)), 1, 0.06);
  EXPECT_NEAR(std::sqrt(t2 / count), 0.008, 0.0005);
}

class ShotFiles : public testing::Test {
 protected:
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("roomcal_shot_files_" + std::to_string(getpid()));
  void TearDown() override { std::filesystem::remove_all(folder_); }
};

TEST_F(ShotFiles, SmallDevice_WritesAllAndTruthFits) {
  const Scene scene = make_room({.seed = 2, .markers = 120});
  const PaperDevice device = scaled(device_named("mobile_robot"), 0.25);  // enough to see the files
  const ShotOptions options{.seed = 3};
  const Stand stand = place_device(scene, device, options);
  const LitScene lit(scene);
  ShotFacts facts;
  std::vector<Picture>& pictures = facts.pictures;
  for (std::size_t i = 0; i < stand.cameras.size(); ++i) {
    pictures.push_back(take_picture(lit, stand.cameras[i], options, i));
    write_picture(pictures.back(), stand.cameras[i].name, {}, folder_);
  }
  facts.recordings.push_back({{{"lidar0.pcap", {}}}, 10, 9});
  write_shot_facts(scene, stand, facts, options, folder_);

  const auto truth = nlohmann::json::parse(read_text(folder_ / "truth.json"));
  EXPECT_EQ(truth.at("extrinsics").size(), 20u);
  EXPECT_EQ(truth.at("cameras").size(), 4u);
  EXPECT_EQ(truth.at("lidars").at("lidar0").at("laser_bias_m").size(), 16u);
  const auto nominal = nlohmann::json::parse(read_text(folder_ / "nominal.json"));
  EXPECT_EQ(nominal.at("edges").size(), 4u);
  EXPECT_EQ(nominal.at("lidars")[0].at("file"), "lidar0.pcap");
  EXPECT_EQ(nominal.at("edges")[0].at("to"), "cam1");
  EXPECT_NE(read_text(folder_ / "camchain.yaml").find("distortion_model: equidistant"), std::string::npos);
  for (const TrueCamera& camera : stand.cameras) EXPECT_TRUE(std::filesystem::exists(folder_ / (camera.name + ".png")));
  // Paper at a marker's middle is bright, the ring around it dark: the picture and its truth agree.
  for (const MarkerTruth& marker : pictures[0].markers) {
    if (marker.visible < 1 || marker.outer.minor_px < 16) continue;
    const int x = static_cast<int>(std::lround(marker.uv_px.x())), y = static_cast<int>(std::lround(marker.uv_px.y()));
    const double turn = marker.outer.angle_rad, out = 0.325 * marker.outer.major_px / 2;
    const int ring_x = static_cast<int>(std::lround(marker.uv_px.x() + out * std::cos(turn)));
    const int ring_y = static_cast<int>(std::lround(marker.uv_px.y() + out * std::sin(turn)));
    EXPECT_GT(pictures[0].image.at<uint8_t>(y, x), 1.5 * pictures[0].image.at<uint8_t>(ring_y, ring_x)) << marker.id;
  }
}

}  // namespace
}  // namespace roomcal::tools
