#include "drivers/libcamera/capture_controls.h"

#include <array>

#include <libcamera/control_ids.h>

#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

namespace {

namespace controls = libcamera::controls;

class Wishes {
 public:
  Wishes(const libcamera::ControlInfoMap& available, HealthLog& log)
      : available_(available), log_(log), list_(controls::controls) {}

  template <typename T, typename V>
  void set(const libcamera::Control<T>& control, const V& value) {
    if (available_.find(control.id()) != available_.end()) return list_.set(control, value);
    std::array<char, 100> line;
    TextWriter out(line);
    out.text("the camera has no control ").text(control.name());
    log_.note_once(out.view());
  }

  libcamera::ControlList list() && { return std::move(list_); }

 private:
  const libcamera::ControlInfoMap& available_;
  HealthLog& log_;
  libcamera::ControlList list_;
};

#ifdef LIBCAMERA_HAS_RPI_VENDOR_CONTROLS_SYNC_MODE
constexpr bool kCanSynchronize = true;
void synchronize(const LibcameraOptions& options, Wishes& wishes) {
  if (options.sync == LibcameraSync::kNone) return;
  const bool server = options.sync == LibcameraSync::kServer;
  wishes.set(controls::rpi::SyncMode, server ? controls::rpi::SyncModeServer : controls::rpi::SyncModeClient);
  if (server) wishes.set(controls::rpi::SyncFrames, options.sync_frames);
}
#else
constexpr bool kCanSynchronize = false;
void synchronize(const LibcameraOptions&, Wishes&) {}
#endif

}  // namespace

bool can_synchronize() { return kCanSynchronize; }

libcamera::ControlList capture_controls(const LibcameraOptions& options, const libcamera::ControlInfoMap& available,
                                        HealthLog& log) {
  Wishes wishes(available, log);
  if (options.frame_rate_hz > 0) {
    const auto period_us = static_cast<int64_t>(1e6 / options.frame_rate_hz);
    const std::array<int64_t, 2> limits_us{period_us, period_us};
    wishes.set(controls::FrameDurationLimits, libcamera::Span<const int64_t, 2>(limits_us));
  }
  if (options.exposure_us > 0 || options.analogue_gain > 0) wishes.set(controls::AeEnable, false);
  if (options.exposure_us > 0) wishes.set(controls::ExposureTime, options.exposure_us);
  if (options.analogue_gain > 0) wishes.set(controls::AnalogueGain, options.analogue_gain);
  synchronize(options, wishes);
  return std::move(wishes).list();
}

bool in_step(const libcamera::ControlList& metadata) {
#ifdef LIBCAMERA_HAS_RPI_VENDOR_CONTROLS_SYNC_MODE
  return metadata.get(controls::rpi::SyncReady).value_or(false);
#else
  static_cast<void>(metadata);
  return false;
#endif
}

}  // namespace roomcal::drivers
