#pragma once

#include <cstdint>
#include <type_traits>

#include "drivers/image/luma.h"
#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"

namespace roomcal::drivers {

/// Software synchronization of several cameras by libcamera itself: Raspberry Pi, from 0.5.2, and only with clocks that
/// PTP or NTP keep together.
enum class LibcameraSync : uint8_t {
  kNone,
  kServer,  ///< gives the beat
  kClient,  ///< keeps to it
};

/// A camera by libcamera. Plain memory: a board's binary profile fills it. What is 0 leaves the camera as it is, unless
/// said otherwise.
struct LibcameraOptions {
  FixedText<159> key;  ///< its id as `cam -l` prints it, or a part of that which only this one has: "imx296"
  int width_px = 0;    ///< 2 at least
  int height_px = 0;
  /// The first that one of the camera's outputs delivers: grey and Bayer are looked for at the sensor first, YUV at the
  /// image processor.
  FixedVector<PixelFormat, 4> formats;

  double frame_rate_hz = 0;
  int32_t exposure_us = 0;  ///< with `gain`; both 0: the camera controls its exposure by itself
  float analogue_gain = 0;  ///< 1: none
  LibcameraSync sync = LibcameraSync::kNone;
  int32_t sync_frames = 100;  ///< of the server, until the beat begins

  int32_t buffers = 4;  ///< 3 to kMaxLibraryBuffers; of the kernel, allocated by libcamera
};
static_assert(std::is_trivially_copyable_v<LibcameraOptions>);

}  // namespace roomcal::drivers
