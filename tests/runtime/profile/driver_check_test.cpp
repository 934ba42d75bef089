#include "runtime/profile/driver_check.h"

#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/runtime/profile/sample_profile.h"

namespace roomcal::profile {
namespace {

Profile with_camera(ImageDriver driver, const std::function<void(CameraWiring&)>& change) {
  Profile profile = test::small_profile();
  profile.cameras[0].wiring.driver = driver;
  profile.cameras[0].wiring.key = "1";
  change(profile.cameras[0].wiring);
  return profile;
}

/// Empty if the drivers can do it.
std::string complaint(const Profile& profile) {
  Reason what = "left from before";
  const Status checked = check_drivers(profile, what);
  EXPECT_EQ(checked.ok(), what.empty());
  EXPECT_TRUE(checked.ok() || checked.code() == StatusCode::kUnsupported);
  return std::string(what.view());
}

struct Case {
  const char* field;
  std::function<void(CameraWiring&)> set;
  std::vector<ImageDriver> drivers;  ///< that know it
};

TEST(CheckDrivers, SettingOfAnotherDriver_IsNamedWithCameraAndRemedy) {
  using D = ImageDriver;
  const std::vector<Case> cases = {
      {"ptp", [](CameraWiring& w) { w.ptp = true; }, {D::kAravis}},
      {"stamp_point", [](CameraWiring& w) { w.stamp_point = StampPoint::kExposureEnd; }, {D::kAravis}},
      {"packet_size_bytes", [](CameraWiring& w) { w.packet_size_bytes = 1400; }, {D::kAravis}},
      {"packet_delay_us", [](CameraWiring& w) { w.packet_delay_us = 0; }, {D::kAravis}},
      {"sync", [](CameraWiring& w) { w.sync = SyncRole::kClient; }, {D::kLibcamera}},
      {"sync_frames", [](CameraWiring& w) { w.sync_frames = 50; }, {D::kLibcamera}},
      {"may_reset_port", [](CameraWiring& w) { w.may_reset_port = true; }, {D::kV4l2}},
      {"trigger_name", [](CameraWiring& w) { w.trigger_setting.name = "Line1"; }, {D::kV4l2, D::kAravis}},
  };
  for (const Case& c : cases)
    for (const D driver : {D::kReplay, D::kV4l2, D::kLibcamera, D::kAravis}) {
      const std::string told = complaint(with_camera(driver, c.set));
      const bool known = std::find(c.drivers.begin(), c.drivers.end(), driver) != c.drivers.end();
      EXPECT_EQ(told.empty(), known) << c.field << ", " << to_string(driver) << ": " << told;
      if (known) continue;
      EXPECT_EQ(told.find("cam0: driver." + std::string(c.field) + " means nothing to " + to_string(driver)), 0U)
          << told;
      EXPECT_NE(told.find("leave it out"), std::string::npos) << told;
    }
}

TEST(CheckDrivers, TriggerThatTheDriverLacks_IsNamedUnlessItMayRunFree) {
  for (const TriggerMode mode : {TriggerMode::kSoftware, TriggerMode::kAction}) {
    Profile profile = with_camera(ImageDriver::kV4l2, [&](CameraWiring& w) { w.trigger = mode; });
    profile.wiring.trigger.kind = mode == TriggerMode::kAction ? TriggerKind::kAction : TriggerKind::kSoftware;
    EXPECT_NE(complaint(profile).find("cam0: driver.trigger: v4l2 knows no"), std::string::npos) << complaint(profile);
    profile.wiring.trigger.may_run_free = true;
    EXPECT_EQ(complaint(profile), "");
    EXPECT_FALSE(obeys(profile.cameras[0], profile.wiring.trigger.kind));
    run_free(profile.cameras[0]);
    EXPECT_TRUE(obeys(profile.cameras[0], profile.wiring.trigger.kind));
  }
}

TEST(CheckDrivers, TriggerThatTheDeviceDoesNotGive_IsNamed) {
  const std::function<void(CameraWiring&)> action = [](CameraWiring& w) { w.trigger = TriggerMode::kAction; };
  Profile profile = with_camera(ImageDriver::kAravis, action);
  for (const TriggerKind kind : {TriggerKind::kNone, TriggerKind::kSoftware, TriggerKind::kLine, TriggerKind::kCan}) {
    profile.wiring.trigger.kind = kind;
    EXPECT_EQ(complaint(profile).find("cam0: driver.trigger: it waits for `action`"), 0U) << complaint(profile);
  }
  profile.wiring.trigger.kind = TriggerKind::kAction;
  EXPECT_EQ(complaint(profile), "");
}

// A strobe's controller may pulse the line, or a box on the CAN bus.
TEST(CheckDrivers, LineThatSomebodyElsePulses_CanWork) {
  Profile profile = with_camera(ImageDriver::kV4l2, [](CameraWiring& w) { w.trigger = TriggerMode::kLine; });
  for (const TriggerKind kind : {TriggerKind::kNone, TriggerKind::kLine, TriggerKind::kCan}) {
    profile.wiring.trigger.kind = kind;
    EXPECT_EQ(complaint(profile), "");
  }
  profile.wiring.trigger.kind = TriggerKind::kSoftware;
  EXPECT_NE(complaint(profile), "");
}

TEST(Synchronization, EveryWay_HasItsWord) {
  Profile profile = with_camera(ImageDriver::kAravis, [](CameraWiring& w) { w.trigger = TriggerMode::kAction; });
  const auto word_of = [&](TriggerKind kind) {
    profile.wiring.trigger.kind = kind;
    return std::string(synchronization(profile));
  };
  EXPECT_EQ(word_of(TriggerKind::kAction), "action");
  profile.cameras[0].wiring.ptp = true;
  EXPECT_EQ(word_of(TriggerKind::kAction), "action, PTP");
  EXPECT_EQ(word_of(TriggerKind::kLine), "line");
  EXPECT_EQ(word_of(TriggerKind::kCan), "CAN");
  EXPECT_EQ(word_of(TriggerKind::kSoftware), "software");
  profile.cameras[0].wiring.trigger = TriggerMode::kLine;
  EXPECT_EQ(word_of(TriggerKind::kNone), "line of others");
  run_free(profile.cameras[0]);
  EXPECT_EQ(word_of(TriggerKind::kNone), "free");
  profile.cameras[0].wiring.sync = SyncRole::kServer;
  EXPECT_EQ(word_of(TriggerKind::kNone), "libcamera sync");
}

}  // namespace
}  // namespace roomcal::profile
