#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "runtime/base/span2d.h"
#include "runtime/base/status.h"
#include "runtime/base/time.h"

namespace roomcal::ports {

/// What came with one image.
struct ImageFacts {
  Stamp exposed;                 ///< start of the exposure, in whatever clock the driver has; see `uncertainty_ns`
  int64_t uncertainty_ns = 0;    ///< how far `exposed` may be from the start of the exposure
  int64_t arrived_ns = 0;        ///< when the host had it, monotonic
  uint32_t sequence = 0;         ///< counted by the sensor or its driver, 0 for the first image after a start
  uint32_t lost_before = 0;      ///< numbers that are missing between the image before this one and this one
  bool first_after_gap = false;  ///< the stream was interrupted before it: numbers do not tell what was lost
};

/// Everything that goes wrong with a camera, one name, one counter and one log line each.
enum class ImageFault : uint8_t {
  kNotFound,        ///< no camera of this key
  kBusy,            ///< somebody else has it
  kDenied,          ///< the system does not let us use it
  kFormat,          ///< it does not deliver the size or format that the profile wants
  kNoMemory,        ///< the system has no buffers left for it
  kNoBandwidth,     ///< the bus cannot carry another stream
  kMarkedDamaged,   ///< the driver itself says that the image is not whole
  kShort,           ///< fewer bytes than an image has
  kUndecodable,     ///< compressed, and not of that format
  kUnknownBuffer,   ///< a buffer came back that was not handed out, or twice
  kStampFuture,     ///< stamped later than now
  kStampBackwards,  ///< stamped before the image before it
  kStampFrozen,     ///< stamped as the image before it
  kStampOld,        ///< stamped more than a second ago
  kStampTai,        ///< 37 s ahead: the camera keeps atomic time (TAI), the host does not
  kStampUnknown,    ///< the driver does not say which clock it is
  kStall,           ///< nothing came for longer than a few images take
  kTransient,       ///< an input error that may pass
  kStale,           ///< the driver no longer agrees with the device about its state
  kEndOfStream,     ///< the stream ended by itself
  kGone,            ///< unplugged
  kCount
};
inline constexpr std::size_t kImageFaults = static_cast<std::size_t>(ImageFault::kCount);
/// "marked damaged". Never null.
const char* to_string(ImageFault fault);
/// What a person can do about it, one clause: "check plug and cable". Never null.
const char* remedy(ImageFault fault);

enum class SourceState : uint8_t {
  kClosed,      ///< not started, or stopped
  kStreaming,   ///< images come
  kRecovering,  ///< they do not, and the driver works on it
  kFaulted,     ///< it has given up; only start() tries again
};
/// "closed", "streaming", "recovering", "faulted".
const char* to_string(SourceState state);

/// Since start(). Monotone but for `state` and `last_fault`.
struct ImageHealth {
  SourceState state = SourceState::kClosed;
  uint64_t images = 0;       ///< handed over
  uint64_t superseded = 0;   ///< whole, but a newer one was there already
  uint64_t lost = 0;         ///< numbers that never came
  uint32_t restarts = 0;     ///< of the stream
  uint32_t reopens = 0;      ///< of the device
  uint32_t port_resets = 0;  ///< of the port that it is plugged into
  std::array<uint32_t, kImageFaults> faults{};
  ImageFault last_fault = ImageFault::kCount;  ///< kCount: none yet
  int error_number = 0;                        ///< errno that came with it; 0: none
};

/// One camera. All calls from the one thread that owns it.
///
/// The camera is found by a key that outlives re-plugging (port path, serial), never by a device number. A source mends
/// itself within next(), see drivers/image/recovery.h; the others do not notice.
class ImageSource {
 public:
  virtual ~ImageSource() = default;

  /// As in the profile, for messages.
  virtual std::string_view name() const = 0;

  /// Finds the camera, configures it, reserves all that it will ever need and starts to stream. Before arming.
  /// @return kOk; kNotFound, kUnavailable (busy, no bandwidth, no buffers), kUnsupported (size or format) with the
  ///         remedy. Except for kUnsupported, next() goes on trying.
  virtual Status start() = 0;

  /// Waits for an image, at most `wait_ns`, and copies the newest one's luminance.
  /// @param into  as large as the profile says.
  /// @param[out] facts  only for kOk.
  /// @return kOk; kUnavailable: none came in that time, health() tells why. `into` then holds anything.
  /// No heap, whatever happens; sources whose library allocates do it in the library's own threads.
  virtual Status next(int64_t wait_ns, MutableImageView into, ImageFacts& facts) = 0;

  virtual void stop() = 0;
  virtual const ImageHealth& health() const = 0;
};

}  // namespace roomcal::ports
