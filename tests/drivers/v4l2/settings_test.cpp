#include "drivers/v4l2/settings.h"

#include <cerrno>
#include <utility>

#include <gtest/gtest.h>

#include "tests/drivers/v4l2/rig.h"

namespace roomcal::drivers::test {
namespace {

using ports::ImageFault;
using ports::SourceState;

int32_t value_of(const FakeCamera& camera, uint32_t id) {
  for (const FakeCamera::Control& control : camera.controls)
    if (control.id == id) return control.value;
  return -12345;
}

void furnish(FakeCamera& camera) {
  for (const FakeCamera::Control& control : {FakeCamera::Control{V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", 3, 0, 3},
                                             {V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", 300, 1, 100},
                                             {V4L2_CID_AUTOGAIN, "Gain, Automatic", 1, 0, 1},
                                             {V4L2_CID_GAIN, "Gain", 100, 0, 255},
                                             {V4L2_CID_PRIVATE_BASE, "Trigger Mode (XVS)", 0, 0, 1}})
    static_cast<void>(camera.controls.push_back(control));
}

TEST(V4l2Settings, Options_AreSetAndPutBackOnClosing) {
  Rig rig;
  furnish(rig.camera);
  rig.camera.controls[1].value = 50;
  ASSERT_TRUE(rig.camera.fourccs.push_back(V4L2_PIX_FMT_YUYV));
  rig.options.formats.clear();
  ASSERT_TRUE(rig.options.formats.push_back(PixelFormat::kGrey8));
  rig.options.fps = 20;
  rig.options.exposure_us = 2540;
  rig.options.gain = 7;
  rig.options.trigger_control = {"trigger_mode_xvs", 1};
  ASSERT_TRUE(rig.source().start().ok());
  EXPECT_EQ(rig.camera.period_ns, 50 * kMs);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_MANUAL);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_EXPOSURE_ABSOLUTE), 25);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_AUTOGAIN), 0);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_GAIN), 7);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_PRIVATE_BASE), 1);
  ASSERT_TRUE(rig.next().ok());
  rig.source().stop();
  EXPECT_EQ(rig.camera.period_ns, 33'333'333);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_EXPOSURE_AUTO), 3);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_EXPOSURE_ABSOLUTE), 50);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_AUTOGAIN), 1);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_GAIN), 100);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_PRIVATE_BASE), 0);
}

// vivid takes 40 for a time between images that is 0.3 us shorter than a thirtieth of a second.
TEST(V4l2Settings, Rate_IsAskedForExactly) {
  for (const auto& [fps, period_ns] :
       {std::pair{30.0, int64_t{33'333'333}}, {29.97, 33'366'700}, {0.5, 2'000'000'000}}) {
    Rig rig;
    rig.camera.period_ns = 10 * kMs;
    rig.options.fps = fps;
    ASSERT_TRUE(rig.source().start().ok());
    EXPECT_EQ(rig.camera.period_ns, period_ns);
    EXPECT_EQ(rig.lines.with("time between images"), 0);
  }
}

TEST(V4l2Settings, NothingAskedFor_NothingIsTouched) {
  Rig rig;
  furnish(rig.camera);
  rig.options.fps = 0;
  ASSERT_TRUE(rig.source().start().ok());
  EXPECT_EQ(rig.kernel.calls(FakeCall::kSetControl), 0);
  EXPECT_EQ(rig.kernel.calls(FakeCall::kSetRate), 0);
}

TEST(V4l2Settings, StartThatFailsHalfway_PutsBackToo) {
  Rig rig;
  furnish(rig.camera);
  rig.options.gain = 7;
  rig.kernel.fail(FakeCall::kStreamOn, ENOSPC);
  const Status started = rig.source().start();
  EXPECT_EQ(started.code(), StatusCode::kUnavailable);
  EXPECT_NE(std::string(started.detail()).find("another bus"), std::string::npos);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_GAIN), 100);
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_AUTOGAIN), 1);
}

TEST(V4l2Settings, ExposureBeyondTheCamerasRange_IsTakenAsItBecameAndSaid) {
  Rig rig;
  furnish(rig.camera);
  rig.options.exposure_us = 20'000;
  rig.camera.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_EOF;
  ASSERT_TRUE(rig.source().start().ok());
  EXPECT_EQ(rig.lines.with("exposure 20000 us became 10000 us"), 1);
  ASSERT_TRUE(rig.next().ok());
  // Complete now, readout up to a period, exposed for 10 ms before.
  EXPECT_NEAR(static_cast<double>(rig.facts.arrived_ns - rig.facts.exposed.ns), 10.0 * kMs + 33.3 * kMs / 2, 0.1 * kMs);
}

TEST(V4l2Settings, CameraWithoutRateExposureAndGain_StreamsAndSaysSo) {
  Rig rig;
  rig.camera.has_rate = false;
  rig.camera.period_ns = 100 * kMs;
  rig.options.exposure_us = 1000;
  rig.options.gain = 3;
  ASSERT_TRUE(rig.source().start().ok());
  EXPECT_TRUE(rig.next(kS).ok());
  EXPECT_EQ(rig.lines.with("time between images 33333 us cannot be set"), 1);
  EXPECT_EQ(rig.lines.with("exposure 1000 us cannot be set"), 1);
  EXPECT_EQ(rig.lines.with("gain 3 cannot be set"), 1);
}

TEST(V4l2Settings, OnlyAnalogueGain_IsUsed) {
  Rig rig;
  ASSERT_TRUE(rig.camera.controls.push_back({V4L2_CID_ANALOGUE_GAIN, "Analogue Gain", 1, 0, 100}));
  rig.options.gain = 42;
  ASSERT_TRUE(rig.source().start().ok());
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_ANALOGUE_GAIN), 42);
  EXPECT_EQ(rig.lines.with("gain"), 0);
}

TEST(V4l2Settings, BusHiccup_IsTriedOnceMore) {
  Rig rig;
  furnish(rig.camera);
  rig.options.gain = 7;
  rig.kernel.fail(FakeCall::kSetControl, EPROTO, 1, 1);
  ASSERT_TRUE(rig.source().start().ok());
  EXPECT_EQ(value_of(rig.camera, V4L2_CID_GAIN), 7);
}

TEST(V4l2Settings, TriggerThatCannotBeSet_IsNoTriggeredCamera) {
  for (const V4l2Control& control : {V4l2Control{"no_such_control", 1}, V4l2Control{"trigger_mode_xvs", 5},
                                     V4l2Control{"trigger", 1}, V4l2Control{"trigger_mode_xvs_2", 1}}) {
    Rig rig;
    furnish(rig.camera);
    rig.options.trigger = TriggerMode::kExternal;
    rig.options.trigger_control = control;
    const Status started = rig.source().start();
    EXPECT_EQ(started.code(), StatusCode::kUnsupported) << control.name.view();
    EXPECT_EQ(rig.state(), SourceState::kFaulted);
    EXPECT_EQ(value_of(rig.camera, V4L2_CID_PRIVATE_BASE), 0);  // put back
  }
}

}  // namespace
}  // namespace roomcal::drivers::test
