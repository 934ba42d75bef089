// A V4L2 camera makes no heap call from its start on, whatever happens to it.

#include <array>
#include <memory>

#include <gtest/gtest.h>

#include "drivers/v4l2/linux_kernel.h"
#include "drivers/v4l2/v4l2_image_source.h"
#include "tests/budget/heap_guard.h"
#include "tests/drivers/v4l2/fake_kernel.h"

namespace roomcal::drivers::test {
namespace {

using ports::ImageFault;

constexpr int64_t kMs = 1'000'000, kS = 1'000'000'000;

struct LineCount final : ports::Log {
  void note(std::string_view /*who*/, std::string_view /*what*/) override { ++lines; }
  int lines = 0;
};

class V4l2Heap : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "the sanitizer brings its own allocator";
#endif
  }

  static V4l2Options options(const char* key) {
    V4l2Options with;
    with.key = key;
    with.width_px = 64;
    with.height_px = 48;
    static_cast<void>(with.formats.push_back(PixelFormat::kGrey8));
    with.exposure_us = 1000;  // which it does not have: that is told
    with.may_reset_port = true;
    return with;
  }

  FakeClocks clocks;
  LineCount log;
  std::array<uint8_t, 64 * 48> pixels{};
  ports::ImageFacts facts;
};

// Images, a dead queue, damage, a wrong stamp, unplugging, plugging in elsewhere, silence up to giving up, stop.
TEST_F(V4l2Heap, ImagesAndEveryKindOfTrouble_NoCall) {
  const auto kernel = std::make_unique<FakeKernel>(clocks);
  FakeCamera& camera = kernel->add("video0", "pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0", "A1");
  V4l2ImageSource source("cam0", options("serial:A1"), *kernel, clocks, log);
  const auto stream = [&](int64_t for_ns) {
    for (const int64_t end = clocks.now_ns() + for_ns; clocks.now_ns() < end;)
      static_cast<void>(source.next(50 * kMs, {pixels.data(), 64, 48}, facts));
  };
  std::size_t calls = 0;
  {
    const budget::HeapGuard guard;
    static_cast<void>(source.start());
    stream(2 * kS);
    kernel->break_queue(camera);
    stream(2 * kS);
    camera.damage_flags = V4L2_BUF_FLAG_ERROR;
    stream(200 * kMs);
    camera.damage_flags = 0;
    camera.stamp_offset_ns = 37 * kS;
    stream(200 * kMs);
    camera.stamp_offset_ns = 0;
    kernel->unplug(camera);
    stream(5 * kS);
    kernel->plug(camera, "video3");
    stream(40 * kS);
    camera.plugged = false;
    kernel->fail(FakeCall::kReset, 5);
    camera.silent = true;
    stream(40 * kS);
    source.stop();
    calls = guard.calls();
  }
  EXPECT_EQ(calls, 0U);
  const ports::ImageHealth& health = source.health();
  EXPECT_GT(health.images, 1000U);
  for (const ImageFault fault : {ImageFault::kEndOfStream, ImageFault::kMarkedDamaged, ImageFault::kStampTai,
                                 ImageFault::kGone, ImageFault::kNotFound, ImageFault::kStall})
    EXPECT_GT(health.faults[static_cast<std::size_t>(fault)], 0U) << to_string(fault);
  EXPECT_GT(log.lines, 6);
}

TEST_F(V4l2Heap, LookingForACameraInSysfs_NoCall) {
  LinuxV4l2Kernel kernel;
  V4l2ImageSource source("cam0", options("serial:no such camera"), kernel, clocks, log);
  std::size_t calls = 0;
  int listed = 0;
  {
    const budget::HeapGuard guard;
    static_cast<void>(source.start());
    static_cast<void>(source.next(30 * kS, {pixels.data(), 64, 48}, facts));
    std::array<NodeName, 8> names;
    listed = LinuxV4l2Kernel("/no sysfs here").list(names);
    calls = guard.calls();
  }
  EXPECT_EQ(calls, 0U);
  EXPECT_EQ(source.health().last_fault, ImageFault::kNotFound);
  EXPECT_LT(listed, 0);
}

}  // namespace
}  // namespace roomcal::drivers::test
