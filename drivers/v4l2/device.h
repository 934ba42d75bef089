#pragma once

#include <cstdint>

#include "drivers/image/health_log.h"
#include "drivers/v4l2/buffer_ring.h"
#include "drivers/v4l2/find_camera.h"
#include "drivers/v4l2/format.h"
#include "drivers/v4l2/handle.h"
#include "drivers/v4l2/options.h"
#include "drivers/v4l2/settings.h"

namespace roomcal::drivers {

/// One camera, found by its key, set up and streaming, or closed.
class V4l2Device {
 public:
  /// @param options, log  outlive this.
  V4l2Device(V4l2Kernel& kernel, const V4l2Options& options, HealthLog& log)
      : kernel_(kernel), options_(options), log_(log), handle_(kernel), guard_(handle_), ring_(handle_) {}
  ~V4l2Device() { close(); }
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  /// From the key to a running stream. On trouble it is closed again, all settings put back.
  Trouble open();
  /// Stops the stream, hands all buffers to the driver, starts it.
  Trouble restart();
  /// Stops, puts settings back, unmaps, closes: whatever any of it says.
  void close();
  /// The camera is gone: unmaps and closes, and asks the driver for nothing, which might not answer any more.
  void abandon();
  /// Makes the camera leave its port and come back. @return kStale for one that is not on USB.
  Trouble reset_port();

  /// Waits for an image.
  /// @return kEndOfStream if the queue is in error, which only a restart clears; kStale if the source changed.
  Trouble wait(int64_t timeout_ns, bool& ready);
  Trouble dequeue(bool& any, FilledBuffer& filled) { return ring_.dequeue(any, filled); }
  Trouble queue(uint32_t index) { return ring_.queue(index); }

  bool is_open() const { return handle_.is_open(); }
  const CaptureFormat& format() const { return format_; }
  const Timing& timing() const { return timing_; }

 private:
  Trouble find_and_open();
  Trouble still_the_same(const CameraKey& key);
  Trouble configure();
  Trouble stream_on();
  void stream_off();
  void listen();
  Trouble read_event();
  void tell_offer() const;
  void tell_what_it_is() const;

  V4l2Kernel& kernel_;
  const V4l2Options& options_;
  HealthLog& log_;
  V4l2Handle handle_;
  SettingsGuard guard_;
  BufferRing ring_;
  VideoNode node_;  // also after closing: where it was
  CaptureFormat format_;
  Timing timing_;
  bool multiplanar_ = false;
};

/// "1-2.3" for a sysfs path below a USB port; empty for others.
std::string_view usb_device_of(std::string_view path);

}  // namespace roomcal::drivers
