#include "drivers/libcamera/libcamera_image_source.h"

#include <algorithm>
#include <cstdint>
#include <memory>

#include "drivers/libcamera/libcamera_camera.h"

namespace roomcal::drivers {

namespace {

RelayOptions relay_for(const LibcameraOptions& options) {
  RelayOptions relay;
  // To look for a camera is to read a list that libcamera keeps.
  relay.recovery.longest_wait_ns = relay.recovery.shortest_wait_ns;
  constexpr double kPeriods = 5;
  if (options.frame_rate_hz > 0)
    relay.recovery.stall_ns =
        std::max(relay.recovery.stall_ns, static_cast<int64_t>(kPeriods * 1e9 / options.frame_rate_hz));
  return relay;
}

}  // namespace

LibcameraImageSource::LibcameraImageSource(std::string_view name, const LibcameraOptions& options,
                                           const ports::SystemClocks& clocks, ports::Log& log)
    : RelaySource(name, relay_for(options), std::make_unique<LibcameraCamera>(name, options, clocks, log), clocks,
                  log) {}

}  // namespace roomcal::drivers
