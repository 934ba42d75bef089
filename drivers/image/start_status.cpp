#include "drivers/image/start_status.h"

namespace roomcal::drivers {

using ports::ImageFault;

Status start_status(ImageFault fault) {
  switch (fault) {
    case ImageFault::kCount:
      return ok_status();
    case ImageFault::kNotFound:
    case ImageFault::kGone:
      return {StatusCode::kNotFound, "the camera was not found; check plug, power and the key in the profile"};
    case ImageFault::kFormat:
      return {StatusCode::kUnsupported,
              "the camera does not deliver what the profile asks for; choose a size, format and trigger that it has"};
    case ImageFault::kBusy:
      return {StatusCode::kUnavailable, "the camera is in use; stop the other program"};
    case ImageFault::kDenied:
      return {StatusCode::kUnavailable,
              "the camera may not be opened; let the service's user into the group of its device (video, plugdev)"};
    case ImageFault::kNoMemory:
      return {StatusCode::kUnavailable,
              "no memory for the camera's buffers; raise cma= or usbcore.usbfs_memory_mb on the kernel's command line"};
    case ImageFault::kNoBandwidth:
      return {StatusCode::kUnavailable,
              "the bus cannot carry another camera; move it to another bus, or lower size or rate"};
    default:
      return {StatusCode::kUnavailable, "the camera cannot be started; check its cable and power"};
  }
}

}  // namespace roomcal::drivers
