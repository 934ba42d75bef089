#include "tools/export/export_command.h"

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include "tests/runtime/store/sample_record.h"
#include "tests/tools/refusal.h"
#include "tools/common/files.h"
#include "tools/device/kalibr.h"
#include "tools/export/record_file.h"
#include "tools/export/result_json.h"

namespace roomcal::tools {
namespace {

namespace fs = std::filesystem;
using store::test::sample_record;
using test::contains;
using test::refusal;

class ExportCommand : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  fs::path folder = fs::temp_directory_path() / ("roomcal_export_" + std::to_string(::getpid()) + "_" +
                                                 testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(ExportCommand, RecordFile_ComesBack) {
  const store::Record record = sample_record(2, 3, 1);
  write_record(folder / "a.record", record);
  EXPECT_TRUE(store::test::same(read_record(folder / "a.record"), record));
}

TEST_F(ExportCommand, DamagedRecord_IsRefusedByName) {
  write_record(folder / "a.record", sample_record(2));
  std::fstream(folder / "a.record", std::ios::in | std::ios::out | std::ios::binary)
      .seekp(300)
      .put('x')
      .put('y')
      .put('z');
  const std::string message = refusal([&] { read_record(folder / "a.record"); });
  EXPECT_TRUE(contains(message, "a.record: corrupt: the record's content is damaged")) << message;
}

TEST_F(ExportCommand, ImpossibleRecord_IsNotWritten) {
  store::Record record = sample_record(2);
  record.sensors[1].T_rig_sensor = SE3();
  EXPECT_TRUE(contains(refusal([&] { write_record(folder / "a.record", record); }), "no measurement"));
  EXPECT_FALSE(fs::exists(folder / "a.record"));
}

TEST_F(ExportCommand, Ros_IsAFolder) {
  write_record(folder / "a.record", sample_record(2, 2, 1));
  export_record(folder / "a.record", "ros", "", folder / "ros");
  for (const char* file :
       {"rig.urdf", "static_transforms.launch.xml", "camera_info/cam0.yaml", "camera_info/cam1.yaml"})
    EXPECT_TRUE(fs::exists(folder / "ros" / file)) << file;
  EXPECT_FALSE(fs::exists(folder / "ros/camera_info/lidar0.yaml"));
}

TEST_F(ExportCommand, UnknownFormatOrCamera_IsNamed) {
  write_record(folder / "a.record", sample_record(2));
  EXPECT_TRUE(contains(refusal([&] { export_record(folder / "a.record", "pdf", "", folder / "o"); }),
                       "--format pdf: formats are"));
  EXPECT_TRUE(
      contains(refusal([&] { export_record(folder / "a.record", "camera_info", "cam9", folder / "o"); }), "no camera"));
}

TEST_F(ExportCommand, KalibrExport_IsWhatTheImportReads) {
  const store::Record record = sample_record(2, 3);
  write_record(folder / "a.record", record);
  export_record(folder / "a.record", "kalibr", "", folder / "camchain.yaml");
  const Device device = parse_kalibr("camchain.yaml", read_text(folder / "camchain.yaml"));
  ASSERT_EQ(device.sensors.size(), 3U);
  EXPECT_EQ(device.sensors[1].intrinsics.fx_px, record.sensors[1].intrinsics.fx_px);
  for (std::size_t i = 1; i < 3; ++i)
    EXPECT_LT((device.sensors[i].nominal->T_rig_sensor.t - record.sensors[i].T_rig_sensor.t).norm(), 1e-9);
}

nlohmann::json result_of(const store::Record& record) {
  nlohmann::json sensors;
  for (const store::SensorRecord& sensor : record.sensors) {
    nlohmann::json& out = sensors[std::string(sensor.name.view())];
    const Mat44 T = sensor.T_rig_sensor.matrix();
    for (int i = 0; i < 16; ++i) out["T_rig_sensor"][i / 4][i % 4] = T(i / 4, i % 4);
    for (int i = 0; i < 36; ++i) out["covariance"][i / 6][i % 6] = sensor.cov_rig_sensor(i / 6, i % 6);
    const camera::Intrinsics& k = sensor.intrinsics;
    out["intrinsics"] = {{"model", "pinhole_radtan"}, {"width_px", k.width_px},    {"height_px", k.height_px},
                         {"fx_px", k.fx_px},          {"fy_px", k.fy_px},          {"cx_px", k.cx_px},
                         {"cy_px", k.cy_px},          {"distortion", k.distortion}};
    out["detections"] = 41;
    out["inliers"] = 39;
  }
  return {{"verdict", "PASS"}, {"rig_frame", "cam0"}, {"reasons", {"one"}}, {"sensors", sensors}};
}

TEST(ResultJson, Result_GivesItsPoses) {
  const store::Record record = sample_record(2, 3);
  const store::Record back = parse_result("r.json", result_of(record).dump());
  ASSERT_EQ(back.sensors.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back.sensors[i].T_rig_sensor.matrix(), record.sensors[i].T_rig_sensor.matrix());
    EXPECT_EQ(back.sensors[i].cov_rig_sensor, record.sensors[i].cov_rig_sensor);
  }
  EXPECT_EQ(back.verdict, Verdict::kPass);
}

TEST(ResultJson, BadResults_AreRefusedWithAReason) {
  const auto message = [](const nlohmann::json& json) { return refusal([&] { parse_result("r.json", json.dump()); }); };
  nlohmann::json failed = result_of(sample_record(2)), no_reference = failed, no_intrinsics = failed, skewed = failed;
  failed["verdict"] = "FAIL_RETRY";
  no_reference["rig_frame"] = "cam7";
  no_intrinsics["sensors"]["cam1"].erase("intrinsics");
  skewed["sensors"]["cam1"]["T_rig_sensor"][0][0] = 3;
  EXPECT_TRUE(contains(message(failed), "r.json: the verdict is FAIL_RETRY"));
  EXPECT_TRUE(contains(message(no_reference), "rig frame"));
  EXPECT_TRUE(contains(message(no_intrinsics), "cam1 has no intrinsics"));
  EXPECT_TRUE(contains(message(skewed), "not a rigid transform"));
  for (const char* text :
       {"", "{", "[]", "{\"verdict\": 3}", "null", "{\"verdict\":\"PASS\",\"sensors\":{\"a\":{\"T_rig_sensor\":[]}}}"})
    EXPECT_TRUE(contains(refusal([&] { parse_result("r.json", text); }), "r.json: ")) << text;
}

}  // namespace
}  // namespace roomcal::tools
