#pragma once

#include <cstdint>
#include <type_traits>

#include "drivers/image/luma.h"
#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"

namespace roomcal::drivers {

/// When a camera exposes.
enum class TriggerMode : uint8_t {
  kFreeRun,   ///< by itself, all the time
  kExternal,  ///< when its trigger input says so: next() is called when an image is expected
};

/// A control by its name as `v4l2-ctl --list-ctrls` prints it: "trigger_mode". Kernel and vendors add them freely.
struct V4l2Control {
  FixedText<31> name;  ///< empty: nothing is set
  int32_t value = 0;
};

/// One camera. Plain memory: a board's binary profile fills it.
struct V4l2Options {
  /// Which camera: see find_camera.h for the language. Never a /dev/video number.
  FixedText<127> key;
  int width_px = 0;
  int height_px = 0;
  FixedVector<PixelFormat, 4> formats;  ///< the first that the camera delivers at exactly this size is taken
  double fps = 30;                      ///< of kFreeRun; 0: as the camera does by itself
  int32_t exposure_us = 0;              ///< 0: the camera's own way
  int32_t gain = -1;                    ///< in the camera's own steps; negative: the camera's own way
  TriggerMode trigger = TriggerMode::kFreeRun;
  V4l2Control trigger_control;  ///< what makes the camera obey `trigger`, if anything has to be set for it
  int32_t buffers = 4;          ///< 4 to 8; the kernel's, each of one image
  bool may_reset_port = false;  ///< of USB: nothing else hangs on that port, and the service may write to sysfs
};
static_assert(std::is_trivially_copyable_v<V4l2Options>);

}  // namespace roomcal::drivers
