#include "drivers/libcamera/request_verdict.h"

namespace roomcal::drivers {

namespace {

// FrameStartup was added after 0.0.3; 0.3.2, the next that Debian has, knows it not yet, 0.7.2 does.
template <typename Status>
bool is_startup(Status frame) {
  if constexpr (requires { Status::FrameStartup; })
    return frame == Status::FrameStartup;
  else
    return false;
}

}  // namespace

RequestVerdict verdict_of(libcamera::Request::Status request, libcamera::FrameMetadata::Status frame) {
  using libcamera::FrameMetadata;
  if (request == libcamera::Request::RequestCancelled || frame == FrameMetadata::FrameCancelled)
    return RequestVerdict::kCancelled;
  if (is_startup(frame)) return RequestVerdict::kSkip;
  return frame == FrameMetadata::FrameSuccess ? RequestVerdict::kWhole : RequestVerdict::kDamaged;
}

}  // namespace roomcal::drivers
