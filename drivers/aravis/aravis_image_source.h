#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <string_view>

#include "drivers/aravis/aravis_options.h"
#include "drivers/aravis/ptp.h"
#include "drivers/relay/relay_source.h"

namespace roomcal::drivers {

/// ports::ImageSource of a GigE Vision or USB3 Vision camera, by Aravis. See drivers/relay for threads and waiting,
/// README.md for clocks and what Aravis costs.
///
/// The camera's former settings are restored by stop(), except that PTP stays on.
class AravisImageSource final : public RelaySource {
 public:
  /// @param name  as in the profile. @param clocks, log  outlive the program's threads: a library that hangs may come
  /// back to them.
  AravisImageSource(std::string_view name, const AravisOptions& options, const ports::SystemClocks& clocks,
                    ports::Log& log);

  /// Bytes of the buffers that start() reserves; 0 for options that cannot work.
  static std::size_t buffer_bytes(const AravisOptions& options);

  /// As of about two seconds ago. Any thread.
  PtpState ptp() const { return *ptp_; }

 private:
  using SharedPtp = std::shared_ptr<std::atomic<PtpState>>;
  AravisImageSource(std::string_view name, const AravisOptions& options, const ports::SystemClocks& clocks,
                    ports::Log& log, SharedPtp ptp);

  SharedPtp ptp_;
};

}  // namespace roomcal::drivers
