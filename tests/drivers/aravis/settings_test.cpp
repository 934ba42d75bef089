#include "drivers/aravis/settings.h"

#include <arv.h>
#include <gtest/gtest.h>

#include "drivers/aravis/glib_handle.h"
#include "drivers/aravis/ptp.h"
#include "tests/drivers/aravis/sfnc_camera.h"
#include "tests/fakes/log_lines.h"

namespace roomcal::drivers {
namespace {

// Aravis' fake camera in this process, described as today's standard has it.
class SettingsTest : public testing::Test {
 protected:
  void SetUp() override {
    arv_set_fake_camera_genicam_filename(description_.path().c_str());
    device_.reset(arv_fake_device_new("SFNC1", nullptr));
    arv_set_fake_camera_genicam_filename(nullptr);
    ASSERT_TRUE(device_);
    features_.attach(device_.get());
  }

  static AravisOptions options() {
    AravisOptions options;
    options.width_px = 640;
    options.height_px = 480;
    return options;
  }
  LibraryResult apply(const AravisOptions& options) { return apply_settings(options, features_, log_); }
  std::string get(const char* name) { return std::string(features_.get(name).view()); }
  uint32_t at(guint64 address) {
    guint32 value = 0;
    arv_device_read_register(device_.get(), address, &value, nullptr);
    return value;
  }

  SfncCameraFile description_;
  GObjectPtr<ArvDevice> device_;
  Features features_;
  fakes::LogLines lines_;
  HealthLog log_{"cam0", lines_};
};

TEST_F(SettingsTest, Number_IsSetAsText) {
  EXPECT_TRUE(features_.set_number("Width", 800));
  EXPECT_EQ(get("Width"), "800");
  EXPECT_TRUE(features_.set_number("Gain", 1.5));
  EXPECT_EQ(at(0x4134), 15U);
  EXPECT_EQ(features_.get_number("Gain", -1), 1.5);
  EXPECT_EQ(features_.get_number("Nothing", -1), -1);
}

TEST_F(SettingsTest, ValueThatItHasAlready_IsNoChange) {
  EXPECT_TRUE(features_.set("ExposureTime", "10000.0"));
  EXPECT_TRUE(features_.set("PixelFormat", "Mono8"));
  EXPECT_EQ(features_.changes(), 0U);
}

TEST_F(SettingsTest, UnknownFeatureOrEntry_IsRefusedInWords) {
  EXPECT_FALSE(features_.set("Nothing", "1"));
  EXPECT_EQ(features_.error(), "Nothing is not a feature of the camera");
  EXPECT_FALSE(features_.set("PixelFormat", "Mono12"));
  EXPECT_NE(features_.error().find("Mono12"), std::string_view::npos);
  EXPECT_EQ(features_.changes(), 0U);
}

TEST_F(SettingsTest, Clamped_TellsWhatWasSet) {
  double exposure_us = 1e6;
  EXPECT_TRUE(features_.set_clamped("ExposureTime", exposure_us));
  EXPECT_EQ(exposure_us, 30000);
  double width_px = 3.2;
  EXPECT_TRUE(features_.set_clamped("Width", width_px));
  EXPECT_EQ(width_px, 16);
}

TEST_F(SettingsTest, AllOptions_ArriveInTheRegisters) {
  AravisOptions want = options();
  want.offset_x_px = 64;
  want.offset_y_px = 32;
  want.pixel_format = "Mono16";
  want.frame_rate_hz = 20;
  want.exposure_us = 2500;
  want.gain = 6;
  ASSERT_TRUE(apply(want).ok());
  EXPECT_EQ(at(0x100), 640U);
  EXPECT_EQ(at(0x104), 480U);
  EXPECT_EQ(at(0x130), 64U);
  EXPECT_EQ(at(0x134), 32U);
  EXPECT_EQ(at(0x128), 0x01100007U);
  EXPECT_EQ(at(0x4110), 1U);
  EXPECT_EQ(at(0x4114), 20U);
  EXPECT_EQ(at(0x120), 2500U);
  EXPECT_EQ(at(0x4134), 60U);
  EXPECT_EQ(exposure_ns(features_, 0), 2'500'000);
  EXPECT_TRUE(lines_.lines().empty());
}

TEST_F(SettingsTest, Everything_IsPutBackBackwards) {
  // As somebody left it: another selector triggers, exposure runs by itself.
  ASSERT_TRUE(features_.set_for_good("TriggerSelector", "FrameBurstStart"));
  ASSERT_TRUE(features_.set_for_good("TriggerMode", "On"));
  ASSERT_TRUE(features_.set_for_good("ExposureAuto", "Continuous"));
  ASSERT_TRUE(features_.set_for_good("OffsetX", "200"));
  std::vector<uint32_t> before;
  const std::vector<guint64> registers{0x100,  0x104,  0x120,  0x128,  0x12c,  0x130,  0x134,
                                       0x300,  0x304,  0x320,  0x324,  0x4100, 0x4110, 0x4114,
                                       0x4120, 0x4130, 0x4134, 0x4140, 0x4204, 0x4208, 0x420c};
  for (const guint64 address : registers) before.push_back(at(address));
  AravisOptions want = options();
  want.exposure_us = 2500;
  want.gain = 6;
  want.trigger = AravisTrigger::kAction;
  want.action_group_key = 7;
  want.offset_x_px = 100;
  ASSERT_TRUE(apply(want).ok());
  EXPECT_EQ(at(0x320), 0U) << "the other selector's trigger is off";
  EXPECT_EQ(at(0x300), 1U);
  EXPECT_EQ(at(0x4120), 0U);
  const std::size_t changes = features_.changes();
  EXPECT_GT(changes, 8U);
  EXPECT_EQ(features_.restore(), changes);
  for (std::size_t i = 0; i < registers.size(); ++i) EXPECT_EQ(at(registers[i]), before[i]) << std::hex << registers[i];
}

TEST_F(SettingsTest, ActionTrigger_SetsKeysAndSelector) {
  AravisOptions want = options();
  want.trigger = AravisTrigger::kAction;
  want.action_device_key = 0xDEADBEEF;
  want.action_group_key = 0x12345678;
  want.action_group_mask = 0x80000001;
  ASSERT_TRUE(apply(want).ok());
  EXPECT_EQ(get("TriggerSource"), "Action1");
  EXPECT_EQ(get("TriggerMode"), "On");
  EXPECT_EQ(at(0x4200), 0xDEADBEEFU);
  EXPECT_EQ(at(0x4204), 1U);
  EXPECT_EQ(at(0x4208), 0x12345678U);
  EXPECT_EQ(at(0x420c), 0x80000001U);
}

TEST_F(SettingsTest, LineTrigger_TakesTheNamedLine) {
  AravisOptions want = options();
  want.trigger = AravisTrigger::kLine;
  ASSERT_TRUE(apply(want).ok());
  EXPECT_EQ(get("TriggerSource"), "Line1");
  want.trigger_source = "Line7";
  const LibraryResult refused = apply(want);
  EXPECT_EQ(refused.fault, ports::ImageFault::kFormat);
  EXPECT_EQ(refused.status.code(), StatusCode::kUnsupported);
  EXPECT_EQ(lines_.count("does not offer the trigger"), 1U);
}

TEST_F(SettingsTest, ExposureBeyondItsRange_IsDoneAsWellAsItCanAndNoted) {
  AravisOptions want = options();
  want.exposure_us = 100'000;
  ASSERT_TRUE(apply(want).ok());
  EXPECT_EQ(at(0x120), 30'000U);
  EXPECT_EQ(lines_.count("ExposureTime: 100000.000 asked, the camera can 30000.000"), 1U);
}

TEST_F(SettingsTest, AutoExposure_IsLeftToTheCamera) {
  AravisOptions want = options();
  want.auto_exposure = true;
  ASSERT_TRUE(apply(want).ok());
  EXPECT_EQ(get("ExposureAuto"), "Continuous");
}

TEST_F(SettingsTest, RegionThatItDoesNotHave_IsRefused) {
  AravisOptions want = options();
  want.width_px = 2049;
  EXPECT_EQ(apply(want).fault, ports::ImageFault::kFormat);
  want = options();
  want.offset_y_px = 1025;
  EXPECT_EQ(apply(want).fault, ports::ImageFault::kFormat);
}

TEST_F(SettingsTest, Ptp_IsSwitchedOnAndLeftOn) {
  EXPECT_EQ(read_ptp(features_), PtpState::kOff);
  AravisOptions want = options();
  ASSERT_TRUE(apply(want).ok());
  EXPECT_EQ(read_ptp(features_), PtpState::kOff) << "as the camera was";
  want.ptp = PtpMode::kEnable;
  ASSERT_TRUE(apply(want).ok());
  EXPECT_EQ(read_ptp(features_), PtpState::kSlave);
  EXPECT_EQ(at(0x4304), 1U) << "the status is latched";
  features_.restore();
  EXPECT_EQ(read_ptp(features_), PtpState::kSlave);
}

TEST_F(SettingsTest, DetachedFeatures_RefuseEverything) {
  features_.let_go();
  EXPECT_FALSE(features_.has("Width"));
  EXPECT_FALSE(features_.set("Width", "100"));
  EXPECT_TRUE(features_.get("Width").empty());
}

}  // namespace
}  // namespace roomcal::drivers
