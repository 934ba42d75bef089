// What becomes of a camera's troubles: each errno of each call, dead queues, wrong buffers, unplugging.

#include <array>
#include <cerrno>
#include <cstdio>
#include <string>

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

// When the kernel begins to say no.
enum class When { kAtStart, kWhileStreaming, kOnComingBack };

// A camera whose calls of a kind fail from a moment on, that many times.
struct FailingCall {
  FailingCall(FakeCall call, int error, When when, int times) {
    furnish(rig);
    if (when != When::kAtStart) {
      static_cast<void>(rig.source().start());
      static_cast<void>(rig.next(kS));
    }
    rig.kernel.fail(call, error, 0, times);
    if (when == When::kAtStart) static_cast<void>(rig.source().start());
    if (when != When::kOnComingBack) return;
    rig.kernel.unplug(rig.camera);
    rig.images(100 * kMs);
    rig.kernel.plug(rig.camera, "video3");
  }

  Rig rig;
};

template <typename Check>
void for_every_errno_of_every_call(int times, const Check& check) {
  constexpr std::array<const char*, 3> kWhen = {" at start", " while streaming", " on coming back"};
  for (int call = 0; call < static_cast<int>(FakeCall::kCount); ++call)
    for (const int error : kErrnos)
      for (std::size_t when = 0; when < kWhen.size(); ++when) {
        SCOPED_TRACE(std::string(to_string(static_cast<FakeCall>(call))) + " " + std::to_string(error) + kWhen[when]);
        FailingCall failing(static_cast<FakeCall>(call), error, static_cast<When>(when), times);
        check(failing.rig, static_cast<When>(when));
        expect_all_given_back(failing.rig);
      }
}

TEST(V4l2Recovery, EveryErrnoOfEveryCallOnce_StreamsAgainOrSaysThatItIsTheFormat) {
  int met = 0;
  for_every_errno_of_every_call(1, [&](Rig& rig, When when) {
    const int images = rig.images(12 * kS);
    const bool hopeless = when == When::kAtStart && rig.faults(ImageFault::kFormat) > 0;
    EXPECT_EQ(rig.state(), hopeless ? SourceState::kFaulted : SourceState::kStreaming);
    EXPECT_TRUE(hopeless || images > 15) << images;
    met += rig.kernel.failed();
  });
  EXPECT_GT(met, 1000);  // the others are calls that the driver had no need of
  std::printf("%d faults met\n", met);
}

TEST(V4l2Recovery, EveryErrnoOfEveryCallForEver_IsNamedAndHealsOrStaysFaulted) {
  for_every_errno_of_every_call(1'000'000'000, [](Rig& rig, When) {
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
  });
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

}  // namespace
}  // namespace roomcal::drivers::test
