#include "runtime/ports/image_source.h"

namespace roomcal::ports {

namespace {

struct FaultText {
  ImageFault fault;
  const char* name;
  const char* remedy;
};

constexpr std::array<FaultText, kImageFaults> kFaults = {{
    {ImageFault::kNotFound, "not found", "check plug, power and the key in the profile"},
    {ImageFault::kBusy, "busy", "stop the other program that uses it"},
    {ImageFault::kDenied, "not permitted",
     "let the service's user into the group of the camera's device (video, plugdev)"},
    {ImageFault::kFormat, "wrong format", "choose a size and format that it offers"},
    {ImageFault::kNoMemory, "no buffers", "raise cma= or usbcore.usbfs_memory_mb on the kernel's command line"},
    {ImageFault::kNoBandwidth, "no bandwidth", "move it to another bus, or lower size or rate"},
    {ImageFault::kMarkedDamaged, "marked damaged", "check the cable"},
    {ImageFault::kShort, "short image", "check the cable and the network's packet size"},
    {ImageFault::kUndecodable, "undecodable image", "check the cable; choose an uncompressed format"},
    {ImageFault::kUnknownBuffer, "unknown buffer", "update the camera's kernel driver"},
    {ImageFault::kStampFuture, "stamp in the future", "check the clock settings of camera and host"},
    {ImageFault::kStampBackwards, "stamp goes backwards", "check the clock settings of camera and host"},
    {ImageFault::kStampFrozen, "stamp stands still", "update the camera's kernel driver"},
    {ImageFault::kStampOld, "stamp is old", "check the clock settings and the load of the host"},
    {ImageFault::kStampTai, "stamp is 37 s ahead", "the camera keeps TAI: let PTP tell the UTC offset"},
    {ImageFault::kStampUnknown, "stamp of an unknown clock", "images are ordered by arrival"},
    {ImageFault::kStall, "no images", "check cable, trigger and power"},
    {ImageFault::kTransient, "input error", "check the cable"},
    {ImageFault::kStale, "driver lost track", "none: it is opened anew"},
    {ImageFault::kEndOfStream, "stream ended", "none: it is started anew"},
    {ImageFault::kGone, "unplugged", "plug it in again"},
}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < kImageFaults; ++i)
    if (kFaults[i].fault != static_cast<ImageFault>(i)) return false;
  return true;
}
static_assert(in_order(), "one row a fault, in the order of ImageFault");

const FaultText* row(ImageFault fault) {
  const auto i = static_cast<std::size_t>(fault);
  return i < kImageFaults ? &kFaults[i] : nullptr;
}

}  // namespace

const char* to_string(ImageFault fault) { return row(fault) == nullptr ? "none" : row(fault)->name; }
const char* remedy(ImageFault fault) { return row(fault) == nullptr ? "none" : row(fault)->remedy; }

const char* to_string(SourceState state) {
  switch (state) {
    case SourceState::kClosed:
      return "closed";
    case SourceState::kStreaming:
      return "streaming";
    case SourceState::kRecovering:
      return "recovering";
    case SourceState::kFaulted:
      return "faulted";
  }
  return "unknown";
}

}  // namespace roomcal::ports
