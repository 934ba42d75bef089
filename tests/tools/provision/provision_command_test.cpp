#include "tools/provision/provision_command.h"

#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/runtime/profile/sample_profile.h"
#include "tests/runtime/store/sample_record.h"
#include "tests/tools/folder_test.h"
#include "tests/tools/refusal.h"
#include "tools/common/files.h"
#include "tools/export/record_file.h"
#include "tools/provision/profile_file.h"

namespace roomcal::tools {
namespace {

namespace fs = std::filesystem;
using test::contains;
using test::refusal;

// As `roomcal import` made it before devices had drivers and wiring.
const char* const kPlainDevice = R"(version: 1
name: robot
rig_frame: cam0
sensors:
  - name: cam0
    kind: camera
    model: pinhole_radtan
    resolution_px: [1280, 800]
    intrinsics_px: [700.2, 700.5, 640.1, 399.5]
    distortion: [-0.25, 0.0625, 0.0001, -0.0002]
  - name: cam1
    kind: camera
    model: pinhole_radtan
    resolution_px: [1280, 800]
    intrinsics_px: [700.2, 700.5, 640.1, 399.5]
    distortion: [-0.25, 0.0625, 0.0001, -0.0002]
    nominal:
      T_rig_sensor: [[0, 0, 1, 0.1], [0, 1, 0, -0.02], [-1, 0, 0, 0.003], [0, 0, 0, 1]]
      sigma_t_m: 0.008
      sigma_rot_deg: 1
  - name: lidar0
    kind: lidar
    model: vlp16
)";

class ProvisionCommand : public test::FolderTest {
 protected:
  void run(std::vector<std::string> words) const {
    CLI::App app;
    int exit_code = 0;
    add_provision_command(app, exit_code);
    std::reverse(words.begin(), words.end());  // CLI11 wants them so
    app.parse(words);
    EXPECT_EQ(exit_code, 0);
  }
  void write_device(const std::string& text) const { write_atomic(path("device.yaml"), text); }
  void provision(const std::string& factory = "") const {
    std::vector<std::string> words = {"provision", file("device.yaml"), "-o", file("out")};
    if (!factory.empty()) words.insert(words.end(), {"--factory", file(factory)});
    run(words);
  }
  std::string refusal_of(const std::string& factory = "") const {
    return refusal([&] { provision(factory); });
  }
};

TEST_F(ProvisionCommand, PlainDevice_GetsAProfileWithDefaultsAndTheDrawingsRecord) {
  write_device(kPlainDevice);
  provision();
  const profile::Profile profile = read_profile(path("out/device.profile"));
  EXPECT_EQ(profile.device.view(), "robot");
  EXPECT_EQ(profile.cameras.size(), 2U);
  EXPECT_EQ(profile.cameras[0].wiring.driver, profile::ImageDriver::kReplay);
  EXPECT_EQ(profile.lidars[0].wiring.port, 2368U);
  EXPECT_EQ(profile.wiring.button.kind, profile::ButtonKind::kNone);
  const store::Record record = read_record(path("out/factory.record"));
  ASSERT_EQ(record.sensors.size(), 2U);  // nobody knows where the LiDAR is
  EXPECT_EQ(record.sensors[1].T_rig_sensor.t, Vec3(0.1, -0.02, 0.003));
  EXPECT_EQ(record.action, store::Action::kProvisioned);
}

TEST_F(ProvisionCommand, Again_ReplacesBothFiles) {
  write_device(kPlainDevice);
  provision();
  write_device(std::string(kPlainDevice) + "serial: RB-2\n");
  provision();
  EXPECT_EQ(read_profile(path("out/device.profile")).serial.view(), "RB-2");
  EXPECT_EQ(read_record(path("out/factory.record")).device_serial.view(), "RB-2");
}

TEST_F(ProvisionCommand, SameDevice_SameBytes) {
  write_device(kPlainDevice);
  provision();
  const std::string profile = read_text(path("out/device.profile")), record = read_text(path("out/factory.record"));
  provision();
  EXPECT_EQ(read_text(path("out/device.profile")), profile);
  EXPECT_EQ(read_text(path("out/factory.record")), record);
}

TEST_F(ProvisionCommand, MeasuredRecord_BecomesTheFactoryRecord) {
  write_device(kPlainDevice);
  const store::Record measured = store::test::sample_record(3, 2, 1);
  write_record(path("measured.record"), measured);
  provision("measured.record");
  const store::Record record = read_record(path("out/factory.record"));
  EXPECT_EQ(record.sensors[1].T_rig_sensor.t, measured.sensors[1].T_rig_sensor.t);
  EXPECT_EQ(record.action, store::Action::kProvisioned);
  EXPECT_TRUE(record.device_serial.empty());  // the device has none
}

TEST_F(ProvisionCommand, MeasuredResult_BecomesTheFactoryRecord) {
  write_device(kPlainDevice);
  std::ofstream(path("result.json")) << R"({"verdict": "PASS", "rig_frame": "cam0", "sensors": {
    "cam0": {"T_rig_sensor": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]],
             "covariance": [[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0]],
             "intrinsics": {"model": "pinhole_radtan", "width_px": 1280, "height_px": 800, "fx_px": 700.2,
                            "fy_px": 700.5, "cx_px": 640.1, "cy_px": 399.5, "distortion": [-0.25, 0.0625, 0.0001, -0.0002]}},
    "cam1": {"T_rig_sensor": [[1,0,0,0.12],[0,1,0,0],[0,0,1,0],[0,0,0,1]],
             "covariance": [[1e-8,0,0,0,0,0],[0,1e-8,0,0,0,0],[0,0,1e-8,0,0,0],[0,0,0,1e-8,0,0],[0,0,0,0,1e-8,0],
                            [0,0,0,0,0,1e-8]],
             "intrinsics": {"model": "pinhole_radtan", "width_px": 1280, "height_px": 800, "fx_px": 700.2,
                            "fy_px": 700.5, "cx_px": 640.1, "cy_px": 399.5, "distortion": [-0.25, 0.0625, 0.0001, -0.0002]}}}})";
  provision("result.json");
  EXPECT_EQ(read_record(path("out/factory.record")).sensors[1].T_rig_sensor.t, Vec3(0.12, 0, 0));
}

TEST_F(ProvisionCommand, BadInput_IsNamedAndNothingIsWritten) {
  EXPECT_TRUE(contains(refusal_of(), "device.yaml")) << refusal_of();  // not there

  std::string text = kPlainDevice;
  write_device(text.replace(text.find("700.2"), 5, "-70.2"));
  EXPECT_TRUE(contains(refusal_of(), "device.yaml: cam0: invalid argument")) << refusal_of();

  write_device(std::string(kPlainDevice) + "    driver: {kind: udp, sender: nowhere}\n");
  EXPECT_TRUE(contains(refusal_of(), "device.yaml: lidar0: sender, local and group are addresses")) << refusal_of();

  write_device(std::string(kPlainDevice) + "wiring:\n  can: {standstill: true}\n");
  EXPECT_TRUE(contains(refusal_of(), "device.yaml: can: standstill needs wiring.can.interface")) << refusal_of();

  write_device(kPlainDevice);
  EXPECT_TRUE(contains(refusal_of("none.record"), "none.record")) << refusal_of("none.record");
  write_atomic(path("rubbish.record"), std::string("rubbish"));
  EXPECT_TRUE(contains(refusal_of("rubbish.record"), "rubbish.record: corrupt")) << refusal_of("rubbish.record");
  write_atomic(path("rubbish.json"), std::string("{"));
  EXPECT_TRUE(contains(refusal_of("rubbish.json"), "rubbish.json: ")) << refusal_of("rubbish.json");
  write_record(path("other.record"), store::test::sample_record(3, 3));
  EXPECT_TRUE(contains(refusal_of("other.record"), "other.record: cam2 is not a sensor of robot"))
      << refusal_of("other.record");
  EXPECT_FALSE(fs::exists(path("out")));
}

// A drawing that puts a second sensor exactly where the reference is says nothing: a device would take it for measured.
TEST_F(ProvisionCommand, MountingExactlyOnTheReference_IsRefused) {
  std::string text = kPlainDevice;
  const std::string T = "[[0, 0, 1, 0.1], [0, 1, 0, -0.02], [-1, 0, 0, 0.003], [0, 0, 0, 1]]";
  write_device(text.replace(text.find(T), T.size(), "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"));
  EXPECT_TRUE(contains(refusal_of(), "a sensor sits exactly on the reference")) << refusal_of();
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(ProvisionCommand, FolderThatCannotBeMade_IsNamed) {
  write_device(kPlainDevice);
  write_atomic(path("out"), std::string("a file is in the way"));
  EXPECT_TRUE(contains(refusal_of(), file("out"))) << refusal_of();
}

TEST_F(ProvisionCommand, ProfileThatIsNone_IsNamed) {
  write_atomic(path("a.profile"), std::string("rubbish"));
  EXPECT_TRUE(contains(refusal([&] { static_cast<void>(read_profile(path("a.profile"))); }),
                       "a.profile: shorter than a profile's header: make it anew with `roomcal provision`"));
}

}  // namespace
}  // namespace roomcal::tools
