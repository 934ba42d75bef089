#include "drivers/libcamera/capture_controls.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <libcamera/control_ids.h>

#include "tests/fakes/log_lines.h"

namespace roomcal::drivers {
namespace {

namespace controls = libcamera::controls;

class CaptureControlsTest : public testing::Test {
 protected:
  using Infos = std::vector<std::pair<const libcamera::ControlId*, libcamera::ControlInfo>>;

  static libcamera::ControlInfoMap available(const Infos& infos) {
    return {libcamera::ControlInfoMap::Map(infos.begin(), infos.end()), controls::controls};
  }
  static libcamera::ControlInfoMap all() {
    return available({{&controls::AeEnable, libcamera::ControlInfo(false, true, true)},
                      exposure(),
                      {&controls::AnalogueGain, libcamera::ControlInfo(1.F, 16.F, 1.F)},
                      {&controls::FrameDurationLimits,
                       libcamera::ControlInfo(int64_t{1'000}, int64_t{1'000'000}, int64_t{33'333})}});
  }
  static Infos::value_type exposure() {
    return {&controls::ExposureTime, libcamera::ControlInfo(int32_t{20}, int32_t{60'000}, int32_t{10'000})};
  }

  LibcameraOptions options_;
  fakes::LogLines lines_;
  HealthLog log_{"cam0", lines_};
};

TEST_F(CaptureControlsTest, NothingAsked_NothingSet) {
  EXPECT_TRUE(capture_controls(options_, all(), log_).empty());
  EXPECT_TRUE(lines_.lines().empty());
}

TEST_F(CaptureControlsTest, ExposureAndGain_SwitchTheAutomaticOff) {
  options_.exposure_us = 2500;
  options_.analogue_gain = 2;
  const libcamera::ControlList list = capture_controls(options_, all(), log_);
  EXPECT_EQ(list.get(controls::AeEnable), false);
  EXPECT_EQ(list.get(controls::ExposureTime), 2500);
  EXPECT_EQ(list.get(controls::AnalogueGain), 2.F);
}

TEST_F(CaptureControlsTest, FrameRate_IsAFixedDuration) {
  options_.frame_rate_hz = 25;
  const libcamera::ControlList list = capture_controls(options_, all(), log_);
  const auto limits = list.get(controls::FrameDurationLimits);
  ASSERT_TRUE(limits.has_value());
  EXPECT_EQ((*limits)[0], 40'000);
  EXPECT_EQ((*limits)[1], 40'000);
}

TEST_F(CaptureControlsTest, ControlThatTheCameraLacks_IsNotedAndLeftOut) {
  options_.exposure_us = 2500;
  const libcamera::ControlList list = capture_controls(options_, available({exposure()}), log_);
  EXPECT_EQ(list.size(), 1U);
  EXPECT_EQ(lines_.count("no control AeEnable"), 1U);
}

}  // namespace
}  // namespace roomcal::drivers
