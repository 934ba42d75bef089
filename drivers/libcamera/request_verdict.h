#pragma once

#include <libcamera/framebuffer.h>
#include <libcamera/request.h>

namespace roomcal::drivers {

/// What to do with a request that has come back.
enum class RequestVerdict : uint8_t {
  kWhole,      ///< an image
  kSkip,       ///< of the sensor's first moments: libcamera says that nobody should look at it
  kDamaged,    ///< the kernel's driver says that it is not whole
  kCancelled,  ///< nothing came: the hardware has timed out, and only a stop and a start bring it back
};
RequestVerdict verdict_of(libcamera::Request::Status request, libcamera::FrameMetadata::Status frame);

}  // namespace roomcal::drivers
