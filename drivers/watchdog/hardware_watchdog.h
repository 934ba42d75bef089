#pragma once

#include <cstdint>
#include <type_traits>

#include "drivers/os/device_path.h"
#include "drivers/os/file_kernel.h"
#include "drivers/os/unique_fd.h"
#include "runtime/base/status.h"
#include "runtime/ports/watchdog.h"

namespace roomcal::drivers {

struct WatchdogOptions {
  DevicePath device = {};  ///< "/dev/watchdog0"
  int timeout_s = 10;      ///< the machine restarts when it was not fed for so long
};
static_assert(std::is_trivially_copyable_v<WatchdogOptions>);

/// The machine's watchdog: runs from start() on. Only stop_in_order() tells it to stop; whoever vanishes otherwise, by
/// a crash or by the destructor, leaves it running, and the machine restarts.
class HardwareWatchdog final : public ports::Watchdog {
 public:
  HardwareWatchdog(const WatchdogOptions& options, FileKernel& kernel) : options_(options), kernel_(kernel) {}

  /// @return kUnavailable if there is none or somebody else (systemd's RuntimeWatchdogSec) has it; kInvalidArgument for
  /// a
  ///         time that is none, or that the device cannot be set to within half and double: the device is then running,
  ///         as opening it starts it, and goes on to be fed.
  Status start();
  void feed() override;
  /// Ends it, as far as the kernel lets us: built or loaded with `nowayout` it runs on, and the machine restarts unless
  /// somebody else opens and feeds it.
  void stop_in_order();

  /// As the device has it; 0 before start().
  int timeout_s() const { return timeout_s_; }
  /// Feeds that the kernel refused.
  uint64_t failed_feeds() const { return failed_feeds_; }

 private:
  WatchdogOptions options_;
  FileKernel& kernel_;
  UniqueFd fd_;
  int timeout_s_ = 0;
  uint64_t failed_feeds_ = 0;
};

}  // namespace roomcal::drivers
