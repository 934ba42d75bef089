#pragma once

#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/v4l2/v4l2_image_source.h"
#include "runtime/ports/log.h"
#include "tests/drivers/v4l2/fake_kernel.h"

namespace roomcal::drivers::test {

constexpr int64_t kMs = 1'000'000, kS = 1'000'000'000;

struct Lines final : ports::Log {
  void note(std::string_view who, std::string_view what) override {
    lines.push_back(std::string(who) + ": " + std::string(what));
  }
  int with(const std::string& part) const {
    int count = 0;
    for (const std::string& line : lines) count += line.find(part) != std::string::npos ? 1 : 0;
    return count;
  }
  std::vector<std::string> lines;
};

inline V4l2Options options_for(const char* key) {
  V4l2Options options;
  options.key = key;
  options.width_px = 64;
  options.height_px = 48;
  static_cast<void>(options.formats.push_back(PixelFormat::kGrey8));
  return options;
}

/// One fake camera on a USB port, and the driver under test.
struct Rig {
  explicit Rig(const V4l2Options& with = options_for("port:*-2"))
      : options(with), camera(kernel.add("video0", "pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0", "A1")) {}

  V4l2ImageSource& source() {
    if (!source_) source_.emplace("cam0", options, kernel, clocks, lines);
    return *source_;
  }
  /// Drops the driver: everything must have been given back then.
  void drop() { source_.reset(); }

  Status next(int64_t wait_ns = 100 * kMs) {
    return source().next(wait_ns, {pixels.data(), options.width_px, options.height_px}, facts);
  }
  /// Images that came in that time, asked for without pause.
  int images(int64_t for_ns) {
    int count = 0;
    for (const int64_t end = clocks.now_ns() + for_ns; clocks.now_ns() < end;)
      if (next(50 * kMs).ok()) ++count;
    return count;
  }
  uint32_t faults(ports::ImageFault fault) { return source().health().faults[static_cast<std::size_t>(fault)]; }
  ports::SourceState state() { return source().health().state; }

  V4l2Options options;
  FakeClocks clocks;
  FakeKernel kernel{clocks};
  Lines lines;
  FakeCamera& camera;
  std::vector<uint8_t> pixels = std::vector<uint8_t>(64 * 48);
  ports::ImageFacts facts;

 private:
  std::optional<V4l2ImageSource> source_;
};

inline void expect_all_given_back(Rig& rig) {
  rig.drop();
  EXPECT_EQ(rig.kernel.open_descriptors(), 0);
  EXPECT_EQ(rig.kernel.mappings(), 0);
  EXPECT_EQ(rig.kernel.misuses(), 0);
}

}  // namespace roomcal::drivers::test
