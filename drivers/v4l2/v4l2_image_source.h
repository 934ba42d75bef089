#pragma once

#include <string_view>

#include "drivers/image/health_log.h"
#include "drivers/image/mjpeg.h"
#include "drivers/image/recovery.h"
#include "drivers/os/locked_memory.h"
#include "drivers/v4l2/device.h"
#include "drivers/v4l2/image_judge.h"
#include "drivers/v4l2/kernel.h"
#include "drivers/v4l2/options.h"
#include "runtime/ports/image_source.h"
#include "runtime/ports/log.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

/// A V4L2 camera: USB (UVC), MIPI CSI-2 behind a driver that captures by itself, virtual. See README.md.
///
/// No heap after start(), and before only for a camera that sends JPEG: buffers are the kernel's, and finding a camera
/// again reads sysfs by system calls. next() mends the camera by the ladder of drivers/image/recovery.h. A step of it
/// is not cut short: opening a USB camera may take a second, and next() then returns later than asked.
///
/// Stamps are kMonotonic. V4L2 stamps are mostly of an image's end; `exposed` is then worked out from exposure and
/// rate, and `uncertainty_ns` tells how well (image_judge.h).
class V4l2ImageSource final : public ports::ImageSource {
 public:
  /// @param name  as in the profile. @param kernel, clocks, log  outlive this.
  V4l2ImageSource(std::string_view name, const V4l2Options& options, V4l2Kernel& kernel,
                  const ports::SystemClocks& clocks, ports::Log& log);

  std::string_view name() const override { return log_.who(); }
  Status start() override;
  Status next(int64_t wait_ns, MutableImageView into, ports::ImageFacts& facts) override;
  void stop() override;
  const ports::ImageHealth& health() const override { return log_.health(); }

 private:
  bool step(int64_t deadline_ns, MutableImageView into, ports::ImageFacts& facts);
  bool watch(int64_t until_ns, MutableImageView into, ports::ImageFacts& facts);
  bool drain(MutableImageView into, ports::ImageFacts& facts);
  Trouble take_newest(FilledBuffer& newest, ports::ImageFacts& facts, bool& any);
  bool hand_over(const FilledBuffer& image, const ports::ImageFacts& facts, MutableImageView into);
  Status prepare();
  Status copy(const FilledBuffer& image, MutableImageView into);
  void open();
  void stream_began();
  void report(const Trouble& trouble);
  void fault(ports::ImageFault fault, int error_number = 0);

  const V4l2Options options_;
  const ports::SystemClocks& clocks_;
  HealthLog log_;
  Recovery recovery_;
  V4l2Device device_;
  ImageJudge judge_;
  LockedMemory mjpeg_memory_;
  MjpegDecoder mjpeg_;
};

}  // namespace roomcal::drivers
