#include "drivers/v4l2/v4l2_image_source.h"

#include <gtest/gtest.h>

#include "tests/drivers/v4l2/rig.h"

namespace roomcal::drivers::test {
namespace {

using ports::ImageFault;
using ports::SourceState;

TEST(V4l2ImageSource, GreyCamera_DeliversEveryImageInOrderWithItsPixels) {
  Rig rig;
  rig.camera.stride = 80;
  ASSERT_TRUE(rig.source().start().ok());
  for (uint32_t i = 0; i < 100; ++i) {
    ASSERT_TRUE(rig.next().ok());
    EXPECT_EQ(rig.facts.sequence, i);
    EXPECT_EQ(rig.facts.lost_before, 0U);
    EXPECT_EQ(rig.facts.first_after_gap, i == 0);
    for (const int at : {0, 63, 64 * 47, 64 * 48 - 1})
      EXPECT_EQ(rig.pixels[static_cast<std::size_t>(at)],
                static_cast<uint8_t>(i + static_cast<uint32_t>(at % 64 + 3 * (at / 64))));
  }
  const ports::ImageHealth& health = rig.source().health();
  EXPECT_EQ(health.state, SourceState::kStreaming);
  EXPECT_EQ(health.images, 100U);
  EXPECT_EQ(health.lost + health.superseded + health.restarts + health.reopens, 0U);
  EXPECT_EQ(health.last_fault, ImageFault::kCount);
  EXPECT_EQ(rig.lines.with("is /dev/video0, 64x48 GREY"), 1);
}

TEST(V4l2ImageSource, EveryFormatOfBothKinds_GivesTheSameLuminance) {
  struct {
    PixelFormat format;
    uint32_t fourcc;
    int stride, step, at;
  } const cases[] = {
      {PixelFormat::kGrey8, V4L2_PIX_FMT_GREY, 64, 1, 0},
      {PixelFormat::kYuyv, V4L2_PIX_FMT_YUYV, 128, 2, 0},
      {PixelFormat::kYuyv, V4L2_PIX_FMT_YVYU, 128, 2, 0},
      {PixelFormat::kUyvy, V4L2_PIX_FMT_UYVY, 128, 2, 1},
      {PixelFormat::kGrey16, V4L2_PIX_FMT_Y16, 160, 2, 1},
      {PixelFormat::kPlanarLuma, V4L2_PIX_FMT_NV12, 96, 1, 0},
      {PixelFormat::kPlanarLuma, V4L2_PIX_FMT_NV12M, 64, 1, 0},
      {PixelFormat::kPlanarLuma, V4L2_PIX_FMT_YUV420, 64, 1, 0},
  };
  for (const auto& c : cases) {
    for (const bool multiplanar : {false, true}) {
      Rig rig;
      rig.options.formats.clear();
      ASSERT_TRUE(rig.options.formats.push_back(PixelFormat::kGrey10));  // which it does not have
      ASSERT_TRUE(rig.options.formats.push_back(c.format));
      rig.camera.fourccs[0] = V4L2_PIX_FMT_RGB24;
      ASSERT_TRUE(rig.camera.fourccs.push_back(c.fourcc));
      rig.camera.stride = c.stride;
      rig.camera.luma_step = c.step;
      rig.camera.luma_at = c.at;
      if (multiplanar) rig.camera.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
      ASSERT_TRUE(rig.source().start().ok()) << fourcc_text(c.fourcc).view();
      ASSERT_TRUE(rig.next().ok());
      ASSERT_TRUE(rig.next().ok());
      for (const int at : {0, 1, 63, 64, 64 * 48 - 1})
        EXPECT_EQ(rig.pixels[static_cast<std::size_t>(at)], static_cast<uint8_t>(1 + at % 64 + 3 * (at / 64)))
            << fourcc_text(c.fourcc).view() << " " << at;
    }
  }
}

TEST(V4l2ImageSource, FormatOrSizeThatTheCameraDoesNotHave_IsUnsupportedAndSaidWithItsOffer) {
  for (const bool size : {false, true}) {
    Rig rig;
    if (size) {
      rig.camera.width = 32;
    } else {
      rig.camera.fourccs[0] = V4L2_PIX_FMT_YUYV;
    }
    const Status started = rig.source().start();
    EXPECT_EQ(started.code(), StatusCode::kUnsupported);
    EXPECT_EQ(rig.state(), SourceState::kFaulted);
    EXPECT_EQ(rig.lines.with(size ? "asked for 64x48 GREY; it offers 32x48 GREY" : "it offers 64x48 YUYV"), 1);
    EXPECT_EQ(rig.kernel.open_descriptors(), 0);
    EXPECT_FALSE(rig.next(kS).ok());
    EXPECT_EQ(rig.state(), SourceState::kFaulted);
  }
}

TEST(V4l2ImageSource, ImpossibleOptions_AreRefusedBeforeAnythingIsOpened) {
  const auto refused = [](auto change) {
    Rig rig;
    change(rig.options);
    const Status started = rig.source().start();
    EXPECT_EQ(started.code(), StatusCode::kUnsupported);
    EXPECT_GT(std::string(started.detail()).size(), 20U);
    EXPECT_EQ(rig.kernel.calls(FakeCall::kOpen), 0);
    EXPECT_EQ(rig.state(), SourceState::kFaulted);
  };
  refused([](V4l2Options& o) { o.key = "/dev/video0"; });
  refused([](V4l2Options& o) { o.key = ""; });
  refused([](V4l2Options& o) { o.width_px = 0; });
  refused([](V4l2Options& o) { o.height_px = -5; });
  refused([](V4l2Options& o) { o.width_px = 1'000'000; });
  refused([](V4l2Options& o) { o.formats.clear(); });
  refused([](V4l2Options& o) { o.fps = -1; });
  refused([](V4l2Options& o) { o.fps = std::numeric_limits<double>::quiet_NaN(); });
  refused([](V4l2Options& o) { o.exposure_us = 2'000'000'000; });
}

TEST(V4l2ImageSource, NotStartedOrStopped_SaysSo) {
  Rig rig;
  EXPECT_EQ(rig.next().code(), StatusCode::kUnavailable);
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.source().stop();
  EXPECT_EQ(rig.state(), SourceState::kClosed);
  EXPECT_EQ(rig.next().code(), StatusCode::kUnavailable);
  EXPECT_EQ(rig.kernel.open_descriptors(), 0);
  EXPECT_EQ(rig.kernel.mappings(), 0);
  EXPECT_TRUE(rig.lines.with("given up") == 0);
  ASSERT_TRUE(rig.source().start().ok());
  EXPECT_TRUE(rig.next().ok());
  EXPECT_EQ(rig.source().health().images, 1U);  // counted since start
}

TEST(V4l2ImageSource, ViewOfAnotherSize_IsRefused) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  std::vector<uint8_t> small(32 * 32);
  EXPECT_EQ(rig.source().next(kS, {small.data(), 32, 32}, rig.facts).code(), StatusCode::kInvalidArgument);
}

TEST(V4l2ImageSource, NoImageInThatTime_WaitsThatLongAndNoLonger) {
  Rig rig;
  rig.camera.silent = true;
  ASSERT_TRUE(rig.source().start().ok());
  const int64_t began = rig.clocks.now_ns();
  EXPECT_EQ(rig.next(200 * kMs).code(), StatusCode::kUnavailable);
  EXPECT_NEAR(static_cast<double>(rig.clocks.now_ns() - began), 200.0 * kMs, 0.1 * kMs);
  EXPECT_EQ(rig.next(0).code(), StatusCode::kUnavailable);
  EXPECT_EQ(rig.next(-5).code(), StatusCode::kUnavailable);
}

TEST(V4l2ImageSource, SeveralImagesWaiting_HandsOverTheNewest) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  rig.clocks.advance_to(rig.clocks.now_ns() + 110 * kMs);  // three more
  ASSERT_TRUE(rig.next().ok());
  EXPECT_EQ(rig.facts.sequence, 3U);
  EXPECT_EQ(rig.facts.lost_before, 0U);
  EXPECT_EQ(rig.pixels[0], 3);
  EXPECT_EQ(rig.source().health().superseded, 2U);
  EXPECT_EQ(rig.source().health().lost, 0U);
}

TEST(V4l2ImageSource, NobodyAskedForLong_OldImagesArePutBackWithoutAFault) {
  for (const uint32_t clock : {V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC, V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN}) {
    Rig rig;
    rig.camera.stamp_flags = static_cast<uint32_t>(clock);
    ASSERT_TRUE(rig.source().start().ok());
    ASSERT_TRUE(rig.next().ok());
    const uint32_t unknown = rig.faults(ImageFault::kStampUnknown);
    rig.clocks.advance_to(rig.clocks.now_ns() + 60 * kS);
    const int64_t asked = rig.clocks.now_ns();
    ASSERT_TRUE(rig.next().ok());
    EXPECT_GE(rig.facts.arrived_ns, asked);
    EXPECT_GT(rig.facts.exposed.ns + rig.facts.uncertainty_ns, asked - 70 * kMs);  // not one of those that waited
    EXPECT_TRUE(rig.facts.first_after_gap);
    EXPECT_EQ(rig.source().health().superseded, 4U);
    EXPECT_EQ(rig.source().health().lost, 0U);  // not asked for is not lost
    EXPECT_EQ(rig.faults(ImageFault::kStampOld), 0U);
    EXPECT_EQ(rig.faults(ImageFault::kStampUnknown), unknown + (unknown > 0 ? 1U : 0U));
    EXPECT_EQ(rig.state(), SourceState::kStreaming);
    EXPECT_EQ(rig.source().health().restarts, 0U);
  }
}

TEST(V4l2ImageSource, LostNumbers_AreCountedExactlyOverTheWrap) {
  Rig rig;
  rig.camera.first_sequence = 0xffffffffU - 5;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  EXPECT_EQ(rig.facts.sequence, 0U);
  uint32_t lost = 0;
  for (int i = 0; i < 30; ++i) {
    rig.camera.lose_next = i % 3;
    lost += static_cast<uint32_t>(i % 3);
    ASSERT_TRUE(rig.next(kS).ok());
    EXPECT_EQ(rig.facts.lost_before, static_cast<uint32_t>(i % 3));
    EXPECT_EQ(rig.facts.sequence, static_cast<uint32_t>(i + 1) + lost);
  }
  EXPECT_EQ(rig.source().health().lost, lost);
  EXPECT_EQ(rig.source().health().last_fault, ImageFault::kCount);
}

TEST(V4l2ImageSource, StartOfTheExposure_LiesWithinItsUncertainty) {
  struct {
    uint32_t source;
    int32_t exposure_us;
    int64_t uncertainty_ns;
  } const cases[] = {
      {V4L2_BUF_FLAG_TSTAMP_SRC_SOE, 0, 1'000'000},
      {V4L2_BUF_FLAG_TSTAMP_SRC_EOF, 0, 33'333'000},     // exposure and readout unknown, each up to a period
      {V4L2_BUF_FLAG_TSTAMP_SRC_EOF, 5000, 16'666'500},  // readout unknown
  };
  for (const auto& c : cases) {
    Rig rig;
    rig.options.exposure_us = c.exposure_us;
    rig.camera.stamp_flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | c.source;
    ASSERT_TRUE(rig.camera.controls.push_back({V4L2_CID_EXPOSURE_AUTO, "Auto Exposure", 3, 0, 3}));
    ASSERT_TRUE(rig.camera.controls.push_back({V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure Time, Absolute", 300, 1, 5000}));
    ASSERT_TRUE(rig.source().start().ok());
    ASSERT_TRUE(rig.next().ok());
    EXPECT_EQ(rig.facts.exposed.clock, ClockId::kMonotonic);
    EXPECT_NEAR(static_cast<double>(rig.facts.uncertainty_ns), static_cast<double>(c.uncertainty_ns), 1000);
    const int64_t stamp_ns = rig.facts.arrived_ns;  // the fake hands an image over as it is complete
    const int64_t latest_ns = stamp_ns - int64_t{c.exposure_us} * 1000;
    EXPECT_LE(rig.facts.exposed.ns, latest_ns);
    EXPECT_NEAR(static_cast<double>(rig.facts.exposed.ns + rig.facts.uncertainty_ns), static_cast<double>(latest_ns),
                1.1e6);
  }
}

TEST(V4l2ImageSource, Dropped_GivesEverythingBack) {
  Rig rig;
  ASSERT_TRUE(rig.source().start().ok());
  ASSERT_TRUE(rig.next().ok());
  EXPECT_EQ(rig.kernel.open_descriptors(), 1);
  EXPECT_EQ(rig.kernel.mappings(), 4);
  rig.drop();
  EXPECT_EQ(rig.kernel.open_descriptors(), 0);
  EXPECT_EQ(rig.kernel.mappings(), 0);
  EXPECT_EQ(rig.kernel.misuses(), 0);
}

}  // namespace
}  // namespace roomcal::drivers::test
