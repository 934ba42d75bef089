#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <string_view>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/aravis/aravis_image_source.h"
#include "drivers/os/linux_clocks.h"
#include "tests/drivers/aravis/fake_cameras.h"
#include "tests/fakes/log_lines.h"

namespace roomcal::drivers {

inline constexpr int64_t kMs = 1'000'000;
inline constexpr int64_t kS = 1'000'000'000;

/// Fake GigE Vision cameras on the loopback of a network of the test's own, and sources of them.
class GigeRig : public testing::Test {
 protected:
  void SetUp() override {
    for (const std::string& why : {enter_own_network(), why_no_fake_cameras()})
      if (!why.empty()) GTEST_SKIP() << why;
  }

  static AravisOptions options_for(std::string_view key) {
    AravisOptions options;
    options.key = key;
    options.width_px = options.height_px = 512;
    return options;
  }
  std::unique_ptr<AravisImageSource> make(const AravisOptions& options, std::string_view name = "cam0") {
    return std::make_unique<AravisImageSource>(name, options, clocks_, log_);
  }

  Status next(AravisImageSource& source, int64_t wait_ns, int width_px = 512, int height_px = 512) {
    pixels_.resize(static_cast<std::size_t>(width_px * height_px));
    return source.next(wait_ns, {pixels_.data(), width_px, height_px}, facts_);
  }
  /// Until the n-th image, at most `within_ns`. @return how many came.
  int images(AravisImageSource& source, int n, int64_t within_ns) {
    int got = 0;
    for (const int64_t end_ns = clocks_.now_ns() + within_ns; got < n && clocks_.now_ns() < end_ns;)
      if (next(source, 100 * kMs).ok()) ++got;
    return got;
  }
  static uint32_t faults(const AravisImageSource& source, ports::ImageFault fault) {
    return source.health().faults[static_cast<std::size_t>(fault)];
  }

  LinuxClocks clocks_;
  fakes::LogLines log_;
  std::vector<uint8_t> pixels_;
  ports::ImageFacts facts_;
};

}  // namespace roomcal::drivers
