#include "drivers/libcamera/libcamera_image_source.h"

#include <vector>

#include <gtest/gtest.h>

#include "drivers/libcamera/capture_controls.h"
#include "drivers/os/linux_clocks.h"
#include "tests/fakes/log_lines.h"

namespace roomcal::drivers {
namespace {

constexpr int64_t kMs = 1'000'000;

class LibcameraImageSourceTest : public testing::Test {
 protected:
  static LibcameraOptions options() {
    LibcameraOptions options;
    options.key = "a camera that nobody has";
    options.width_px = 640;
    options.height_px = 480;
    static_cast<void>(options.formats.push_back(PixelFormat::kPlanarLuma));
    return options;
  }
  Status start(const LibcameraOptions& options) { return LibcameraImageSource("cam0", options, clocks_, log_).start(); }

  LinuxClocks clocks_;
  fakes::LogLines log_;
};

TEST_F(LibcameraImageSourceTest, UnknownId_IsNotFoundAndTheCamerasThereAreListed) {
  LibcameraImageSource source("cam0", options(), clocks_, log_);
  EXPECT_EQ(source.start().code(), StatusCode::kNotFound);
  EXPECT_EQ(log_.count("cam0: cameras there: "), 1U);
  std::vector<uint8_t> pixels(640 * 480);
  ports::ImageFacts facts;
  EXPECT_EQ(source.next(2500 * kMs, {pixels.data(), 640, 480}, facts).code(), StatusCode::kUnavailable);
  EXPECT_EQ(source.health().state, ports::SourceState::kRecovering);
  EXPECT_GE(source.health().faults[static_cast<std::size_t>(ports::ImageFault::kNotFound)], 2U) << "it goes on looking";
  EXPECT_EQ(log_.count("cameras there"), 1U);
}

TEST_F(LibcameraImageSourceTest, TwoSources_ShareTheOneManager) {
  LibcameraImageSource one("cam0", options(), clocks_, log_);
  LibcameraImageSource other("cam1", options(), clocks_, log_);
  EXPECT_EQ(one.start().code(), StatusCode::kNotFound);
  EXPECT_EQ(other.start().code(), StatusCode::kNotFound);
  one.stop();
  EXPECT_EQ(one.start().code(), StatusCode::kNotFound);
}

TEST_F(LibcameraImageSourceTest, OptionsThatCannotWork_AreRefused) {
  LibcameraOptions wrong = options();
  wrong.key = "";
  EXPECT_EQ(start(wrong).code(), StatusCode::kUnsupported);
  wrong = options();
  wrong.formats.clear();
  EXPECT_EQ(start(wrong).code(), StatusCode::kUnsupported);
  wrong = options();
  wrong.height_px = 20'000;
  EXPECT_EQ(start(wrong).code(), StatusCode::kUnsupported);
  wrong = options();
  wrong.buffers = 17;
  EXPECT_EQ(start(wrong).code(), StatusCode::kUnsupported);
  EXPECT_TRUE(log_.lines().empty()) << "nobody was asked";
}

TEST_F(LibcameraImageSourceTest, Synchronization_IsRefusedWhereThisLibcameraHasNone) {
  LibcameraOptions wanted = options();
  wanted.sync = LibcameraSync::kClient;
  EXPECT_EQ(start(wanted).code(), can_synchronize() ? StatusCode::kNotFound : StatusCode::kUnsupported);
}

}  // namespace
}  // namespace roomcal::drivers
