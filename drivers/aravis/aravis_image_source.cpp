#include "drivers/aravis/aravis_image_source.h"

#include <algorithm>
#include <utility>

#include "drivers/aravis/aravis_camera.h"

namespace roomcal::drivers {

namespace {

constexpr int64_t kSecondNs = 1'000'000'000;

RelayOptions relay_for(const AravisOptions& options) {
  RelayOptions relay;
  // Torn images are usual on a busy network and no reason to interrupt the stream.
  relay.recovery.damaged_in_a_row = 25;
  // To look for a camera costs one datagram to each network.
  relay.recovery.longest_wait_ns = kSecondNs;
  constexpr double kPeriods = 5;
  if (options.frame_rate_hz > 0)
    relay.recovery.stall_ns =
        std::max(relay.recovery.stall_ns, static_cast<int64_t>(kPeriods * 1e9 / options.frame_rate_hz));
  return relay;
}

}  // namespace

AravisImageSource::AravisImageSource(std::string_view name, const AravisOptions& options,
                                     const ports::SystemClocks& clocks, ports::Log& log)
    : AravisImageSource(name, options, clocks, log, std::make_shared<std::atomic<PtpState>>(PtpState::kNone)) {}

AravisImageSource::AravisImageSource(std::string_view name, const AravisOptions& options,
                                     const ports::SystemClocks& clocks, ports::Log& log, SharedPtp ptp)
    : RelaySource(name, relay_for(options), std::make_unique<AravisCamera>(name, options, clocks, log, ptp), clocks,
                  log),
      ptp_(std::move(ptp)) {}

std::size_t AravisImageSource::buffer_bytes(const AravisOptions& options) {
  return AravisCamera::buffer_bytes(options);
}

}  // namespace roomcal::drivers
