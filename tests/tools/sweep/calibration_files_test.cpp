#include "tools/sweep/calibration_files.h"

#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/refusal.h"

namespace roomcal::tools {
namespace {

using lidar::Model;
using nlohmann::json;
using test::contains;
using test::refusal;

std::string xt16_csv(const std::string& head) {
  std::string text = head;
  for (int i = 16; i >= 1; --i) text += std::to_string(i) + "," + std::to_string(15 - 2 * (i - 1)) + ",0.5\r\n";
  return text;
}

TEST(HesaiCsv, AnyOrderOfChannels_IsSorted) {
  for (const char* head :
       {"Channel,Elevation,Azimuth\n", "Laser id,Elevation,Azimuth\r\n", "EEFF,1,1\nLaser id,E,A\n", ""}) {
    const lidar::Calibration calibration = parse_hesai_csv(Model::kXt16, "a.csv", xt16_csv(head));
    EXPECT_EQ(calibration.beam_count, 16);
    EXPECT_TRUE(calibration.from_unit);
    EXPECT_NEAR(calibration.beams[0].elevation_rad, deg_to_rad(15), 1e-12);
    EXPECT_NEAR(calibration.beams[15].elevation_rad, deg_to_rad(-15), 1e-12);
    EXPECT_NEAR(calibration.beams[3].azimuth_offset_rad, deg_to_rad(0.5), 1e-12);
  }
}

TEST(HesaiCsv, BadTables_NameFileAndFault) {
  const auto says = [](Model model, const std::string& text, const std::string& part) {
    const std::string got = refusal([&] { static_cast<void>(parse_hesai_csv(model, "a.csv", text)); });
    EXPECT_TRUE(contains(got, "a.csv") && contains(got, part)) << "wanted: " << part << ", got: " << got;
  };
  says(Model::kXt32, xt16_csv(""), "16 lasers, a Hesai PandarXT-32 has 32");
  says(Model::kXt16, xt16_csv("1,1,1\n"), "17 lasers");
  says(Model::kXt16, "1,2\n", "expected 3 numbers");
  says(Model::kXt16, "1,2,nan\n2,x,1\n3,4,5\n", "1 lasers");
  std::string twice = xt16_csv("");
  twice.replace(0, 2, "15");
  says(Model::kXt16, twice, "stands twice");
  std::string flat;
  for (int i = 1; i <= 16; ++i) flat += std::to_string(i) + ",3,0\n";
  says(Model::kXt16, flat, "one elevation");
  std::string steep = xt16_csv("");
  steep.replace(steep.find("-15"), 3, "195");
  says(Model::kXt16, steep, "not finite or absurd");
}

std::string vlp16_yaml() {
  std::string text = "lasers:\n";
  for (int i = 0; i < 16; ++i) {
    text += "  - {laser_id: " + std::to_string(i) +
            ", rot_correction: 0.01, vert_correction: " + std::to_string(0.01 * (i - 8)) +
            ", dist_correction: 0.002, vert_offset_correction: 0.011}\n";
  }
  return text + "num_lasers: 16\ndistance_resolution: 0.002\n";
}

TEST(VelodyneYaml, RosDriversFile_GivesBeamsWithOffsets) {
  const lidar::Calibration calibration = parse_velodyne_yaml(Model::kVlp16, "v.yaml", vlp16_yaml());
  EXPECT_NEAR(calibration.beams[10].elevation_rad, 0.02, 1e-9);
  EXPECT_NEAR(calibration.beams[10].azimuth_offset_rad, -0.01, 1e-12) << "the file's correction is subtracted";
  EXPECT_NEAR(calibration.beams[10].range_offset_m, 0.002, 1e-12);
  EXPECT_NEAR(calibration.beams[10].vertical_offset_m, 0.011, 1e-12);
}

TEST(VelodyneYaml, BadFiles_NameLineAndFault) {
  const auto says = [](std::string text, const std::string& part) {
    const std::string got = refusal([&] { static_cast<void>(parse_velodyne_yaml(Model::kVlp16, "v.yaml", text)); });
    EXPECT_TRUE(contains(got, "v.yaml") && contains(got, part)) << "wanted: " << part << ", got: " << got;
  };
  says("lasers: 3\n", "must be a list");
  says("lasers: []\n", "0 lasers");
  std::string twice = vlp16_yaml();
  twice.replace(twice.find("laser_id: 5"), 11, "laser_id: 4");
  says(twice, "stands twice");
  std::string wild = vlp16_yaml();
  wild.replace(wild.find("0.002"), 5, ".nan ");
  says(wild, "finite number");
}

json ouster() {
  json metadata = {{"prod_sn", "122150000150"},
                   {"lidar_mode", "1024x10"},
                   {"lidar_origin_to_beam_origin_mm", 27.67},
                   {"data_format",
                    {{"columns_per_frame", 1024},
                     {"columns_per_packet", 16},
                     {"column_window", {100, 900}},
                     {"pixels_per_column", 32},
                     {"udp_profile_lidar", "RNG19_RFL8_SIG16_NIR16_DUAL"}}}};
  for (int i = 0; i < 32; ++i) {
    metadata["beam_altitude_angles"].push_back(20 - i);
    metadata["beam_azimuth_angles"].push_back(i % 4 - 1.5);
  }
  return metadata;
}

TEST(OusterJson, FlatAndNested_GiveTheSame) {
  json nested = {{"sensor_info", {{"prod_sn", "122150000150"}}}, {"config_params", {{"lidar_mode", "1024x10"}}}};
  const json flat = ouster();
  nested["lidar_data_format"] = flat["data_format"];
  nested["beam_intrinsics"] = {
      {"beam_altitude_angles", flat["beam_altitude_angles"]},
      {"beam_azimuth_angles", flat["beam_azimuth_angles"]},
      {"beam_to_lidar_transform", {{1, 0, 0, 27.67}, {0, 1, 0, 0}, {0, 0, 1, 3}, {0, 0, 0, 1}}}};
  const lidar::Calibration a = parse_ouster_json("m.json", flat.dump()), b = parse_ouster_json("m.json", nested.dump());
  for (const lidar::Calibration* c : {&a, &b}) {
    EXPECT_EQ(c->beam_count, 32);
    EXPECT_EQ(c->ouster.profile, lidar::OusterProfile::kDual19);
    EXPECT_EQ(c->ouster.serial, 122150000150U);
    EXPECT_EQ(lidar::window_columns(c->ouster), 801U);
    EXPECT_NEAR(c->ouster.beam_origin_m, 0.02767, 1e-12);
    EXPECT_NEAR(c->ouster.T_sensor_lidar(2, 3), 0.03618, 1e-12);
  }
  EXPECT_NEAR(b.ouster.beam_origin_z_m, 0.003, 1e-12);
}

TEST(OusterJson, BadMetadata_NamesTheKey) {
  struct Bad {
    std::string expected;
    std::function<void(json&)> apply;
  };
  for (const Bad& bad : std::vector<Bad>{
           {"profile `RNG99` is not read", [](json& j) { j["data_format"]["udp_profile_lidar"] = "RNG99"; }},
           {"lists of one length", [](json& j) { j["beam_azimuth_angles"].erase(0); }},
           {"`beam_altitude_angles` must be a number", [](json& j) { j["beam_altitude_angles"][3] = "up"; }},
           {"is this Ouster metadata", [](json& j) { j.erase("beam_altitude_angles"); }},
           {"disagree", [](json& j) { j["data_format"]["pixels_per_column"] = 64; }},
           {"`columns_per_packet` must be a whole number",
            [](json& j) { j["data_format"]["columns_per_packet"] = 99; }},
           {"`column_window` is not understood",
            [](json& j) {
              j["data_format"]["column_window"] = {0, 5000};
            }},
           {"not a rigid transform",
            [](json& j) { j["lidar_to_sensor_transform"] = {9, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }},
           {"must have 16 numbers",
            [](json& j) {
              j["lidar_to_sensor_transform"] = {1, 2, 3};
            }},
       }) {
    json metadata = ouster();
    bad.apply(metadata);
    const std::string got = refusal([&] { static_cast<void>(parse_ouster_json("m.json", metadata.dump())); });
    EXPECT_TRUE(contains(got, "m.json") && contains(got, bad.expected))
        << "wanted: " << bad.expected << ", got: " << got;
  }
  EXPECT_TRUE(contains(refusal([] { static_cast<void>(parse_ouster_json("m.json", "{")); }), "not JSON"));
}

TEST(RobosenseCsv, SixteenLines_AreTheLasersInOrder) {
  std::string text;
  for (int i = 0; i < 16; ++i) text += std::to_string(15 - 2 * i) + ",-3.5\t\n";
  const lidar::Calibration calibration = parse_robosense_csv("h.csv", text);
  EXPECT_NEAR(calibration.beams[1].elevation_rad, deg_to_rad(13), 1e-12);
  EXPECT_NEAR(calibration.beams[1].azimuth_offset_rad, deg_to_rad(-3.5), 1e-12);
}

TEST(ReadCalibration, WithoutFile_BuiltInOrNamed) {
  EXPECT_EQ(read_calibration(Model::kVlp32c, "").beam_count, 32);
  EXPECT_FALSE(read_calibration(Model::kVlp16, "").from_unit);
  EXPECT_TRUE(contains(refusal([] { static_cast<void>(read_calibration(Model::kXt32, "")); }), "angle file (CSV)"));
  EXPECT_TRUE(contains(refusal([] { static_cast<void>(read_calibration(Model::kOuster, "")); }), "metadata JSON"));
}

}  // namespace
}  // namespace roomcal::tools
