#include "tools/report/result_file.h"

#include "tests/runtime/store/sample_record.h"
#include "tests/tools/folder_test.h"
#include "tests/tools/refusal.h"
#include "tests/tools/report/sample_result.h"
#include "tools/common/files.h"
#include "tools/export/record_file.h"

namespace roomcal::tools {
namespace {

using test::contains;
using test::refusal;
using test::sample_places;
using test::sample_result;

class ResultFileTest : public test::FolderTest {
 protected:
  ResultFile read(const nlohmann::json& json) const {
    write_atomic(path("r.json"), json.dump());
    return read_result(path("r.json"));
  }
};

TEST_F(ResultFileTest, Result_GivesSensorsWithTheirPoses) {
  const std::vector<SE3> places = sample_places();
  const ResultFile result = read(sample_result(places));
  EXPECT_EQ(result.rig_frame, "cam0");
  ASSERT_EQ(result.sensors.size(), 3U);
  const SensorResult* cam2 = result.find("cam2");
  ASSERT_NE(cam2, nullptr);
  ASSERT_TRUE(cam2->T_room_sensor && cam2->T_rig_sensor && cam2->camera);
  EXPECT_LT(se3_log(cam2->T_room_sensor->inverse() * places[2]).norm(), 1e-12);
  EXPECT_EQ(cam2->cov_rig_sensor(3, 3), 1e-8);
  EXPECT_EQ(result.find("cam9"), nullptr);
}

TEST_F(ResultFileTest, Lidar_KeepsModelFileAndBeamOffsets) {
  nlohmann::json json = sample_result(sample_places());
  json["sensors"]["lidar0"] = {{"kind", "lidar"},  {"model", "vlp16"}, {"file", "scan.pcap"},  {"sweeps", 3},
                               {"sigma_m", 0.012}, {"located", false}, {"failure", "too dark"}};
  json["sensors"]["lidar0"]["beam_offsets"] = {{{"beam", 2}, {"offset_m", 0.004}, {"sigma_m", 0.001}, {"points", 9}}};
  const ResultFile result = read(json);
  const SensorResult* lidar = result.find("lidar0");
  ASSERT_TRUE(lidar != nullptr && lidar->lidar);
  EXPECT_EQ(lidar->lidar->model, "vlp16");
  EXPECT_EQ(lidar->lidar->file, "scan.pcap");
  EXPECT_EQ(lidar->lidar->sweeps, 3U);
  EXPECT_EQ(lidar->lidar->sigma_m, 0.012);
  EXPECT_EQ(lidar->lidar->beam_offset_m[2], 0.004);
  EXPECT_FALSE(lidar->T_room_sensor.has_value());
}

TEST_F(ResultFileTest, Record_IsReadAsWell) {
  const store::Record record = store::test::sample_record(2, 3, 1);
  write_record(path("a.record"), record);
  const ResultFile result = read_result(path("a.record"));
  ASSERT_EQ(result.sensors.size(), record.sensors.size());
  for (std::size_t i = 0; i < record.sensors.size(); ++i) {
    const SensorResult* sensor = result.find(std::string(record.sensors[i].name.view()));
    ASSERT_TRUE(sensor != nullptr && sensor->T_rig_sensor);
    EXPECT_LT(se3_log(sensor->T_rig_sensor->inverse() * record.sensors[i].T_rig_sensor).norm(), 1e-9);
    EXPECT_FALSE(sensor->T_room_sensor.has_value());
  }
}

TEST_F(ResultFileTest, BadInput_IsRefusedByFileAndReason) {
  nlohmann::json no_lens = sample_result(sample_places()), skewed = no_lens, no_beam = no_lens, no_verdict = no_lens;
  no_lens["sensors"]["cam1"].erase("intrinsics");
  skewed["sensors"]["cam1"]["T_room_sensor"][0].erase(0);
  no_beam["sensors"]["l"] = {{"kind", "lidar"}, {"beam_offsets", {{{"beam", 100'000}, {"offset_m", 0}}}}};
  no_verdict.erase("verdict");
  EXPECT_TRUE(contains(refusal([&] { read(no_lens); }), "cam1: a camera without intrinsics"));
  EXPECT_TRUE(contains(refusal([&] { read(skewed); }), "cam1"));
  EXPECT_TRUE(contains(refusal([&] { read(no_beam); }), "a beam that no LiDAR has"));
  EXPECT_TRUE(contains(refusal([&] { read(no_verdict); }), "no verdict"));
  for (const char* text : {"", "{", "[]", "3", R"({"verdict": 3, "sensors": {}})", "ROOMCAL?"}) {
    write_atomic(path("bad"), text);
    EXPECT_TRUE(contains(refusal([&] { read_result(path("bad")); }), file("bad"))) << text;
  }
  EXPECT_TRUE(contains(refusal([&] { read_result(path("none")); }), file("none")));
}

}  // namespace
}  // namespace roomcal::tools
