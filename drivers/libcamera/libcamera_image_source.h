#pragma once

#include <string_view>

#include "drivers/libcamera/libcamera_options.h"
#include "drivers/relay/relay_source.h"

namespace roomcal::drivers {

/// ports::ImageSource of a camera that libcamera drives: MIPI CSI-2 with an image processor, UVC. See drivers/relay for
/// threads and waiting, README.md for versions and clocks.
class LibcameraImageSource final : public RelaySource {
 public:
  /// @param name  as in the profile. @param clocks, log  outlive the program's threads: a library that hangs may come
  ///              back to them.
  LibcameraImageSource(std::string_view name, const LibcameraOptions& options, const ports::SystemClocks& clocks,
                       ports::Log& log);
};

}  // namespace roomcal::drivers
