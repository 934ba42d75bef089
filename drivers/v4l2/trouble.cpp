#include "drivers/v4l2/trouble.h"

#include <array>
#include <cerrno>

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

constexpr uint32_t at(V4l2Call call) { return uint32_t{1} << static_cast<uint32_t>(call); }
constexpr uint32_t kAny = at(V4l2Call::kCount) - 1;
constexpr uint32_t kConfigure = at(V4l2Call::kSetFormat) | at(V4l2Call::kSetRate) | at(V4l2Call::kControl);

struct Row {
  int error_number;
  uint32_t calls;
  ImageFault fault;
};

// The first row that fits counts. Sources: the kernel's uAPI pages of each ioctl and "Generic Error Codes"; what only
// the field taught is said beside the row.
constexpr auto kTable = std::to_array<Row>({
    {EAGAIN, at(V4l2Call::kDequeue), ImageFault::kCount},  // nothing there
    {ENOENT, at(V4l2Call::kEvent), ImageFault::kCount},    // nothing there
    {ENODEV, kAny, ImageFault::kGone},
    {ENXIO, kAny, ImageFault::kGone},
    {ESHUTDOWN, kAny, ImageFault::kGone},  // USB: the endpoint went with the device
    {ENOENT, at(V4l2Call::kOpen) | at(V4l2Call::kFind), ImageFault::kNotFound},
    {ENOENT, kAny, ImageFault::kGone},  // UVC: the control's interface went
    {EACCES, at(V4l2Call::kOpen), ImageFault::kDenied},
    {EPERM, at(V4l2Call::kOpen), ImageFault::kDenied},
    {EINVAL, kConfigure, ImageFault::kFormat},  // no such format, rate, control
    {ENOTTY, kConfigure, ImageFault::kFormat},
    {ERANGE, kConfigure, ImageFault::kFormat},
    {EACCES, kConfigure, ImageFault::kFormat},  // a control that is read-only, or grabbed by another
    {EPERM, kConfigure, ImageFault::kFormat},
    {EPIPE, kConfigure, ImageFault::kFormat},                 // USB: the camera stalls a request that it does not want
    {ENOTTY, at(V4l2Call::kQueryCaps), ImageFault::kFormat},  // no V4L2 device at all
    {EINVAL, at(V4l2Call::kQueryCaps), ImageFault::kFormat},
    {EPIPE, at(V4l2Call::kStreamOn), ImageFault::kFormat},    // the media pipeline's pads disagree about the format
    {ENOLINK, at(V4l2Call::kStreamOn), ImageFault::kFormat},  // the media pipeline's links are not set up
    {EPIPE, kAny, ImageFault::kEndOfStream},
    {EBUSY, kAny, ImageFault::kBusy},
    {ENOMEM, kAny, ImageFault::kNoMemory},  // of USB cameras: usbfs or DMA; of others: CMA
    {ENOBUFS, kAny, ImageFault::kNoMemory},
    {EMFILE, kAny, ImageFault::kNoMemory},
    {ENFILE, kAny, ImageFault::kNoMemory},
    {ENOSPC, kAny, ImageFault::kNoBandwidth},  // USB: periodic transfers are booked up
    {EINVAL, kAny, ImageFault::kStale},
    {ENOTTY, kAny, ImageFault::kStale},
    {EBADF, kAny, ImageFault::kStale},
    {EFAULT, kAny, ImageFault::kStale},
});

}  // namespace

Trouble trouble_of(V4l2Call call, int error_number) {
  for (const Row& row : kTable)
    if (row.error_number == error_number && (row.calls & at(call)) != 0) return {row.fault, error_number};
  return {ImageFault::kTransient, error_number};  // EIO, EPROTO, ETIMEDOUT, EINTR beyond its bound, and what is new
}

}  // namespace roomcal::drivers
