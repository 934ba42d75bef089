#pragma once

#include <cstddef>
#include <span>
#include <variant>

#include "drivers/replay/replay_image_source.h"
#include "drivers/v4l2/linux_kernel.h"
#include "drivers/v4l2/v4l2_image_source.h"
#include "runtime/base/status.h"
#include "runtime/profile/profile.h"
#if ROOMCAL_ARAVIS
#include "drivers/aravis/aravis_image_source.h"
#endif
#if ROOMCAL_LIBCAMERA
#include "drivers/libcamera/libcamera_image_source.h"
#endif

namespace roomcal::board {

/// What image drivers need of the board; outlives them.
struct ImageDriverParts {
  const ports::SystemClocks& clocks;
  ports::Log& log;
  drivers::V4l2Kernel& v4l2;
  const drivers::ReplayCursor& replay;
};

/// The driver that brings one camera's images, as the profile chooses it.
class ImageDriver {
 public:
  /// Bytes of memory that it wants; the kernel's and a library's own buffers are theirs.
  static std::size_t memory_bytes(const profile::CameraProfile& camera, const drivers::ReplayCursor& replay);

  /// @param trigger  the device's, which action cameras must agree with.
  /// @param memory  memory_bytes(), outlives the driver.
  /// @return kUnsupported if this program was built without it, or for a pixel format that is none.
  Status choose(const profile::CameraProfile& camera, const profile::TriggerWiring& trigger,
                const ImageDriverParts& parts, std::span<std::byte> memory);

  ports::ImageSource& source() { return *source_; }
#if ROOMCAL_ARAVIS || ROOMCAL_LIBCAMERA
  /// For software triggers; null for a driver that has none.
  drivers::RelaySource* relay() { return relay_; }
#endif

 private:
  std::variant<std::monostate, drivers::ReplayImageSource, drivers::V4l2ImageSource
#if ROOMCAL_ARAVIS
               ,
               drivers::AravisImageSource
#endif
#if ROOMCAL_LIBCAMERA
               ,
               drivers::LibcameraImageSource
#endif
               >
      driver_;
  ports::ImageSource* source_ = nullptr;
#if ROOMCAL_ARAVIS || ROOMCAL_LIBCAMERA
  drivers::RelaySource* relay_ = nullptr;
#endif
};

}  // namespace roomcal::board
