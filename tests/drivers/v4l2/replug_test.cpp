// Cameras that go, come back under another number, or are not the only one.

#include <string>

#include <gtest/gtest.h>

#include "drivers/v4l2/v4l2_image_source.h"
#include "tests/drivers/v4l2/rig.h"

namespace roomcal::drivers::test {
namespace {

using ports::ImageFault;
using ports::SourceState;

TEST(V4l2Replug, UnpluggedAndPluggedInUnderAnotherNumber_IsFoundByItsPort) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.kernel.unplug(rig.camera);
  EXPECT_EQ(rig.images(20 * kS), 0);
  EXPECT_EQ(rig.state(), SourceState::kRecovering);
  EXPECT_EQ(rig.faults(ImageFault::kGone), 1U);
  EXPECT_EQ(rig.kernel.open_descriptors(), 0);
  EXPECT_EQ(rig.kernel.mappings(), 0);
  EXPECT_EQ(rig.kernel.calls(FakeCall::kStreamOff), 0);  // a camera that is gone is not asked to stop
  FakeCamera& other = rig.kernel.add("video0", "pci0000:00/0000:00:14.0/usb1/1-3/1-3:1.0", "A1");
  other.width = 32;
  rig.kernel.plug(rig.camera, "video7");
  const int64_t plugged = rig.clocks.now_ns();
  while (!rig.next().ok()) ASSERT_LT(rig.clocks.now_ns() - plugged, 5 * kS);
  EXPECT_EQ(rig.state(), SourceState::kStreaming);
  EXPECT_EQ(rig.source().health().reopens, 1U);
  EXPECT_EQ(rig.lines.with("is /dev/video7"), 1);
  EXPECT_EQ(rig.lines.with("unplugged; plug it in again"), 1);
  EXPECT_EQ(rig.lines.with("not found"), 1);
  rig.images(15 * kS);
  EXPECT_EQ(rig.lines.with("over: unplugged"), 1);
}

TEST(V4l2Replug, UnpluggedAHundredTimes_LeaksNothingAndAlwaysComesBack) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  const char* nodes[] = {"video0", "video1", "video2"};
  for (int i = 0; i < 100; ++i) {
    rig.kernel.unplug(rig.camera);
    rig.images(i * 100 * kMs);
    rig.kernel.plug(rig.camera, nodes[i % 3]);
    EXPECT_GT(rig.images(6 * kS), 20) << i;
  }
  expect_all_given_back(rig);
}

TEST(V4l2Replug, NotThereAtTheStart_StartSaysSoAndNextGoesOnTrying) {
  Rig rig;
  rig.camera.plugged = false;
  const Status started = rig.source().start();
  EXPECT_EQ(started.code(), StatusCode::kNotFound);
  EXPECT_NE(std::string(started.detail()).find("check plug"), std::string::npos);
  EXPECT_EQ(rig.images(10 * kS), 0);
  rig.kernel.plug(rig.camera, "video1");
  EXPECT_GT(rig.images(6 * kS), 20);
  EXPECT_EQ(rig.state(), SourceState::kStreaming);
}

TEST(V4l2Replug, TwoCamerasOfOneSerial_AreNamedAndNeitherIsTaken) {
  V4l2Options options = options_for("serial:A1");
  Rig rig(options);
  FakeCamera& other = rig.kernel.add("video2", "pci0000:00/0000:00:14.0/usb1/1-3/1-3:1.0", "A1");
  const Status started = rig.source().start();
  EXPECT_EQ(started.code(), StatusCode::kNotFound);
  EXPECT_EQ(rig.images(10 * kS), 0);
  ASSERT_EQ(rig.lines.with("the key fits more than one"), 1);
  EXPECT_EQ(rig.lines.with("1-2/1-2:1.0"), 1);
  EXPECT_EQ(rig.lines.with("video2 at "), 1);
  EXPECT_EQ(rig.kernel.open_descriptors(), 0);
  rig.kernel.unplug(other);
  EXPECT_GT(rig.images(6 * kS), 20);
}

TEST(V4l2Replug, NumberGoesToAnotherCameraBetweenFindingAndOpening_TheOtherIsNotTaken) {
  Rig rig;
  rig.kernel.add("video5", "pci0000:00/0000:00:14.0/usb1/1-3/1-3:1.0", "B2");
  // The first open is the search's own question; the swap happens before the second.
  rig.kernel.before(FakeCall::kOpen, [](FakeKernel& kernel) {
    kernel.before(FakeCall::kOpen, [](FakeKernel& swapped) {
      swapped.plug(swapped.camera(0), "video5");
      swapped.plug(swapped.camera(1), "video0");
    });
  });
  EXPECT_FALSE(rig.source().start().ok());
  EXPECT_EQ(rig.faults(ImageFault::kStale), 1U);
  EXPECT_GT(rig.images(3 * kS), 20);
  EXPECT_EQ(rig.lines.with("is /dev/video5"), 1);
  EXPECT_EQ(rig.lines.with("is /dev/video0"), 0);
}

TEST(V4l2Replug, SomebodyElseStreams_IsSaidAndWaitedFor) {
  Rig rig;
  V4l2ImageSource first("cam1", rig.options, rig.kernel, rig.clocks, rig.lines);
  ASSERT_TRUE(first.start().ok());
  const Status started = rig.source().start();
  EXPECT_EQ(started.code(), StatusCode::kUnavailable);
  EXPECT_NE(std::string(started.detail()).find("other program"), std::string::npos);
  EXPECT_EQ(rig.images(3 * kS), 0);
  EXPECT_TRUE(first.next(kS, {rig.pixels.data(), 64, 48}, rig.facts).ok());  // undisturbed
  first.stop();
  EXPECT_GT(rig.images(6 * kS), 20);
}

}  // namespace
}  // namespace roomcal::drivers::test
