// What becomes of a camera's troubles: each errno of each call, dead queues, wrong buffers, unplugging.

#include <cerrno>

#include <gtest/gtest.h>

#include "drivers/v4l2/v4l2_image_source.h"
#include "tests/drivers/v4l2/rig.h"

namespace roomcal::drivers::test {
namespace {

using ports::ImageFault;
using ports::SourceState;

constexpr int kErrnos[] = {EPERM,  ENOENT, EINTR,   EIO,       ENXIO,   EBADF,     EAGAIN,    ENOMEM, EACCES,
                           EFAULT, EBUSY,  ENODEV,  EINVAL,    ENFILE,  EMFILE,    ENOTTY,    ENOSPC, EPIPE,
                           ERANGE, EPROTO, ENOBUFS, ETIMEDOUT, ENOLINK, ESHUTDOWN, EREMOTEIO, 4095};

void expect_all_given_back(Rig& rig) {
  rig.drop();
  EXPECT_EQ(rig.kernel.open_descriptors(), 0);
  EXPECT_EQ(rig.kernel.mappings(), 0);
  EXPECT_EQ(rig.kernel.misuses(), 0);
}

// What a camera with everything that can be set makes of it.
void furnish(Rig& rig) {
  rig.options.fps = 3;
  rig.camera.period_ns = 333'333'333;
  rig.options.exposure_us = 5000;
  rig.options.gain = 20;
  rig.options.trigger_control.name = "trigger_mode";
  rig.options.may_reset_port = true;
  for (const FakeCamera::Control& control : {FakeCamera::Control{V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", 3, 0, 3},
                                             {V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", 300, 1, 5000},
                                             {V4L2_CID_AUTOGAIN, "Gain, Automatic", 1, 0, 1},
                                             {V4L2_CID_GAIN, "Gain", 100, 0, 255},
                                             {V4L2_CID_PRIVATE_BASE, "Trigger Mode", 0, 0, 1}})
    static_cast<void>(rig.camera.controls.push_back(control));
}

TEST(V4l2Recovery, EveryErrnoOfEveryCallOnce_StreamsAgainOrSaysThatItIsTheFormat) {
  int cases = 0;
  for (int kind = 0; kind < static_cast<int>(FakeCall::kCount); ++kind) {
    for (const int error : kErrnos) {
      for (const bool while_streaming : {false, true}) {
        SCOPED_TRACE(std::string(to_string(static_cast<FakeCall>(kind))) + " " + std::to_string(error) +
                     (while_streaming ? " while streaming" : " at start"));
        Rig rig;
        furnish(rig);
        if (while_streaming) {
          static_cast<void>(rig.source().start());
          ASSERT_TRUE(rig.next(kS).ok());
        }
        rig.kernel.fail(static_cast<FakeCall>(kind), error, 0, 1);
        if (!while_streaming) static_cast<void>(rig.source().start());
        ++cases;
        const int images = rig.images(12 * kS);
        const bool hopeless = !while_streaming && rig.faults(ImageFault::kFormat) > 0;
        EXPECT_EQ(rig.state(), hopeless ? SourceState::kFaulted : SourceState::kStreaming);
        EXPECT_TRUE(hopeless || images > 15) << images;
        expect_all_given_back(rig);
      }
    }
  }
  std::printf("%d cases\n", cases);
}

TEST(V4l2Recovery, EveryErrnoOfEveryCallForEver_IsNamedAndHealsOrStaysFaulted) {
  for (int kind = 0; kind < static_cast<int>(FakeCall::kCount); ++kind) {
    for (const int error : kErrnos) {
      for (const bool while_streaming : {false, true}) {
        SCOPED_TRACE(std::string(to_string(static_cast<FakeCall>(kind))) + " " + std::to_string(error) +
                     (while_streaming ? " while streaming" : " at start"));
        Rig rig;
        furnish(rig);
        if (while_streaming) {
          static_cast<void>(rig.source().start());
          ASSERT_TRUE(rig.next(kS).ok());
        }
        rig.kernel.fail(static_cast<FakeCall>(kind), error);
        if (!while_streaming) static_cast<void>(rig.source().start());
        rig.images(60 * kS);
        const ports::ImageHealth before = rig.source().health();
        // Whoever does not stream says why; lines do not grow with time.
        EXPECT_TRUE(before.state == SourceState::kStreaming || before.last_fault != ImageFault::kCount);
        EXPECT_LE(rig.lines.lines.size(), 20U);
        EXPECT_LE(rig.kernel.open_descriptors(), 1);
        rig.kernel.heal();
        rig.images(10 * kS);
        // Looked for for ever, or given up; then only start() tries again.
        EXPECT_EQ(rig.state(), before.state == SourceState::kFaulted ? SourceState::kFaulted : SourceState::kStreaming);
        EXPECT_TRUE(rig.source().start().ok());
        EXPECT_TRUE(rig.next(kS).ok());
        expect_all_given_back(rig);
      }
    }
  }
}

TEST(V4l2Recovery, QueueInError_IsRestarted) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.kernel.break_queue(rig.camera);
  EXPECT_GT(rig.images(kS), 20);
  EXPECT_EQ(rig.faults(ImageFault::kEndOfStream), 1U);
  EXPECT_EQ(rig.source().health().restarts, 1U);
  EXPECT_EQ(rig.source().health().reopens, 0U);
  EXPECT_EQ(rig.state(), SourceState::kStreaming);
}

TEST(V4l2Recovery, FirstImageAfterARestart_IsMarked) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  EXPECT_TRUE(rig.facts.first_after_gap);
  ASSERT_TRUE(rig.next().ok());
  EXPECT_FALSE(rig.facts.first_after_gap);
  rig.kernel.break_queue(rig.camera);
  ASSERT_TRUE(rig.next().ok());
  EXPECT_TRUE(rig.facts.first_after_gap);
  EXPECT_EQ(rig.facts.sequence, 0U);
}

TEST(V4l2Recovery, SilentCamera_IsNoticedByItsImagesAndBroughtBack) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.silent = true;
  const int64_t began = rig.clocks.now_ns();
  while (rig.faults(ImageFault::kStall) == 0) static_cast<void>(rig.next());
  EXPECT_LT(rig.clocks.now_ns() - began, 600 * kMs);
  EXPECT_EQ(rig.state(), SourceState::kRecovering);
  rig.camera.silent = false;
  EXPECT_GT(rig.images(kS), 20);
  EXPECT_EQ(rig.state(), SourceState::kStreaming);
  EXPECT_EQ(rig.source().health().restarts, 1U);
}

TEST(V4l2Recovery, CameraThatStaysSilent_IsGivenUpAfterItsBudgetAndSaysSoOnce) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  rig.camera.silent = true;
  EXPECT_EQ(rig.images(60 * kS), 0);
  EXPECT_EQ(rig.state(), SourceState::kFaulted);
  const ports::ImageHealth& health = rig.source().health();
  EXPECT_EQ(health.restarts, 2U);
  EXPECT_EQ(health.reopens, 2U);
  EXPECT_EQ(health.port_resets, 0U);
  EXPECT_EQ(rig.lines.with("given up after 2 restarts and 2 reopens"), 1);
  EXPECT_EQ(rig.lines.with("cam0: no images; check cable, trigger and power"), 1);
  EXPECT_EQ(rig.kernel.open_descriptors(), 0);
  rig.camera.silent = false;
  EXPECT_EQ(rig.images(60 * kS), 0);
  ASSERT_TRUE(rig.source().start().ok());
  EXPECT_GT(rig.images(kS), 20);
}

TEST(V4l2Recovery, PortThatMayBeReset_IsTheLastStep) {
  Rig rig;
  rig.options.may_reset_port = true;
  ASSERT_TRUE(rig.source().start().ok());
  rig.camera.silent = true;  // the fake's reset ends that
  rig.images(60 * kS);
  EXPECT_EQ(rig.kernel.calls(FakeCall::kReset), 1);
  EXPECT_EQ(rig.source().health().port_resets, 1U);
  EXPECT_EQ(rig.state(), SourceState::kStreaming);
}

TEST(V4l2Recovery, TriggeredCamera_IsNotStalledWhileNobodyAsks) {
  Rig rig;
  rig.options.trigger = TriggerMode::kExternal;
  ASSERT_TRUE(rig.source().start().ok());
  rig.camera.silent = true;
  for (int i = 0; i < 100; ++i) {
    rig.clocks.advance_to(rig.clocks.now_ns() + 60 * kS);
    EXPECT_FALSE(rig.next(10 * kMs).ok());
  }
  EXPECT_EQ(rig.state(), SourceState::kStreaming);
  EXPECT_EQ(rig.faults(ImageFault::kStall), 0U);
}

TEST(V4l2Recovery, BuffersMarkedDamaged_AreDroppedAndThreeInARowRestart) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(rig.next().ok());
    rig.camera.damage_flags = V4L2_BUF_FLAG_ERROR;
    rig.clocks.advance_to(rig.clocks.now_ns() + 34 * kMs);
    static_cast<void>(rig.next(0));
    rig.camera.damage_flags = 0;
  }
  EXPECT_EQ(rig.faults(ImageFault::kMarkedDamaged), 20U);
  EXPECT_EQ(rig.source().health().restarts, 0U);
  EXPECT_EQ(rig.source().health().lost, 0U);  // they came
  EXPECT_EQ(rig.lines.with("marked damaged"), 1);
  ASSERT_TRUE(rig.next().ok());
  rig.camera.damage_flags = V4L2_BUF_FLAG_ERROR;
  for (int i = 0; rig.source().health().restarts == 0 && i < 100; ++i) EXPECT_FALSE(rig.next(10 * kMs).ok());
  EXPECT_EQ(rig.faults(ImageFault::kMarkedDamaged), 23U);
}

TEST(V4l2Recovery, ImagesOneByteShort_AreNeverHandedOver) {
  Rig rig;
  rig.camera.missing_bytes = 1;
  ASSERT_TRUE(rig.source().start().ok());
  EXPECT_EQ(rig.images(2 * kS), 0);
  EXPECT_GE(rig.faults(ImageFault::kShort), 3U);
  EXPECT_EQ(rig.faults(ImageFault::kStall), 0U);
}

TEST(V4l2Recovery, BufferThatIsNotThere_Restarts) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.returned_index = 100;
  while (rig.source().health().restarts == 0) static_cast<void>(rig.next(10 * kMs));
  EXPECT_EQ(rig.faults(ImageFault::kUnknownBuffer), 1U);
  rig.camera.returned_index = -1;
  EXPECT_GT(rig.images(kS), 20);
}

TEST(V4l2Recovery, SameBufferTwice_Restarts) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.returned_index = 2;
  rig.clocks.advance_to(rig.clocks.now_ns() + 70 * kMs);  // two images, both said to be in buffer 2
  static_cast<void>(rig.next(0));
  rig.camera.returned_index = -1;
  EXPECT_EQ(rig.faults(ImageFault::kUnknownBuffer), 1U);
  EXPECT_GT(rig.images(kS), 20);
  EXPECT_EQ(rig.source().health().restarts, 1U);
  EXPECT_EQ(rig.state(), SourceState::kStreaming);
}

TEST(V4l2Recovery, StampsThatCannotBeBelieved_ImagesAreStampedByTheirArrival) {
  struct {
    ImageFault fault;
    void (*spoil)(FakeCamera&);
  } const cases[] = {
      {ImageFault::kStampFrozen, [](FakeCamera& c) { c.frozen_stamp = true; }},
      {ImageFault::kStampFuture, [](FakeCamera& c) { c.stamp_offset_ns = 5 * kS; }},
      {ImageFault::kStampTai, [](FakeCamera& c) { c.stamp_offset_ns = 37 * kS; }},
      {ImageFault::kStampUnknown, [](FakeCamera& c) { c.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_COPY; }},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(to_string(c.fault));
    Rig rig;
    ASSERT_TRUE(rig.source().start().ok());
    ASSERT_TRUE(rig.next().ok());
    c.spoil(rig.camera);
    for (int i = 0; i < 10; ++i) {
      ASSERT_TRUE(rig.next().ok());
      const int64_t complete_ns = rig.facts.arrived_ns;
      EXPECT_EQ(rig.facts.exposed.clock, ClockId::kMonotonic);
      EXPECT_LE(rig.facts.exposed.ns, complete_ns);
      EXPECT_LT(rig.facts.uncertainty_ns, 100 * kMs);
      EXPECT_GE(rig.facts.exposed.ns + rig.facts.uncertainty_ns, complete_ns - 1);  // it may have begun just now
    }
    EXPECT_EQ(rig.faults(c.fault), 10U);
    EXPECT_EQ(rig.state(), SourceState::kStreaming);
    EXPECT_EQ(rig.lines.with(to_string(c.fault)), 1);
  }
}

TEST(V4l2Recovery, StampsGoBackOnce_OnlyThatOneIsDoubted) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.stamp_offset_ns = -50 * kMs;
  ASSERT_TRUE(rig.next().ok());
  rig.camera.stamp_offset_ns = 0;
  ASSERT_TRUE(rig.next().ok());
  EXPECT_EQ(rig.faults(ImageFault::kStampBackwards), 1U);
}

TEST(V4l2Recovery, SameStampAndNumberAsBefore_IsNotHandedOverTwice) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.frozen_stamp = rig.camera.frozen_sequence = true;
  rig.images(kS);
  const uint64_t images = rig.source().health().images;
  EXPECT_LE(images, 4U);
  EXPECT_GT(rig.faults(ImageFault::kStampFrozen), 5U);
  EXPECT_GE(rig.faults(ImageFault::kStall), 1U);
}

TEST(V4l2Recovery, ImagesThatComeLate_AreNotHandedOver) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.camera.stamp_offset_ns = -2 * kS;
  EXPECT_EQ(rig.images(400 * kMs), 0);
  EXPECT_GT(rig.faults(ImageFault::kStampOld), 5U);
}

TEST(V4l2Recovery, UnpluggedAndPluggedInUnderAnotherNumber_IsFoundByItsPort) {
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

TEST(V4l2Recovery, UnpluggedAHundredTimes_LeaksNothingAndAlwaysComesBack) {
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

TEST(V4l2Recovery, NotThereAtTheStart_StartSaysSoAndNextGoesOnTrying) {
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

TEST(V4l2Recovery, TwoCamerasOfOneSerial_AreNamedAndNeitherIsTaken) {
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

TEST(V4l2Recovery, NumberGoesToAnotherCameraBetweenFindingAndOpening_TheOtherIsNotTaken) {
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

TEST(V4l2Recovery, SourceChanged_IsOpenedAnewWithItsFormatChecked) {
  for (const bool other_size : {false, true}) {
    Rig rig;
    ASSERT_TRUE(rig.source().start().ok());
    ASSERT_TRUE(rig.next().ok());
    if (other_size) rig.camera.width = 32;
    rig.kernel.raise_event(rig.camera, V4L2_EVENT_SOURCE_CHANGE);
    rig.images(3 * kS);
    EXPECT_EQ(rig.faults(ImageFault::kStale), 1U);
    EXPECT_EQ(rig.faults(ImageFault::kFormat), other_size ? 2U : 0U);  // its budget of reopenings
    EXPECT_EQ(rig.state(), other_size ? SourceState::kFaulted : SourceState::kStreaming);
  }
}

TEST(V4l2Recovery, StreamThatCannotBeStopped_IsClosedAllTheSame) {
  for (const int error : {EIO, ENODEV, EINTR}) {
    Rig rig;
    ASSERT_TRUE(rig.source().start().ok());
    ASSERT_TRUE(rig.next().ok());
    rig.kernel.fail(FakeCall::kStreamOff, error);
    rig.kernel.fail(FakeCall::kRequestBuffers, error);
    rig.source().stop();
    EXPECT_EQ(rig.kernel.open_descriptors(), 0);
    EXPECT_EQ(rig.kernel.mappings(), 0);
  }
}

TEST(V4l2Recovery, SomebodyElseStreams_IsSaidAndWaitedFor) {
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
