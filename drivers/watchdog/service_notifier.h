#pragma once

#include <cstdint>
#include <string_view>

#include <sys/socket.h>
#include <sys/un.h>

#include "drivers/os/unique_fd.h"
#include "runtime/base/status.h"
#include "runtime/ports/watchdog.h"

namespace roomcal::drivers {

/// Tells the service manager how the service is: the datagrams of sd_notify(3), without its library. Does nothing where
/// nobody listens. Sends do not wait: what cannot be sent now is counted and left out.
class ServiceNotifier final : public ports::Watchdog {
 public:
  /// @param socket  the environment's NOTIFY_SOCKET: a path, or "@name" (abstract); null or empty: nobody listens.
  /// @return kInvalidArgument for what is neither or too long; kUnavailable if nobody is there now: messages are sent
  /// all
  ///         the same, a service manager may come back.
  Status start(const char* socket);

  void ready();
  void stopping();
  /// One line that `systemctl status` shows; cut at 200 characters, control characters become spaces.
  void status(std::string_view text);
  /// WATCHDOG=1. Only the supervised loop calls it, see ports::Watchdog.
  void feed() override;

  /// Whether there is somebody to tell.
  bool active() const { return fd_.valid(); }
  uint64_t unsent() const { return unsent_; }

 private:
  void send(std::string_view message);

  UniqueFd fd_;
  sockaddr_un address_{};
  socklen_t address_bytes_ = 0;
  uint64_t unsent_ = 0;
};

/// How often the service manager wants to hear from this process at least: WATCHDOG_USEC of the environment, where
/// WATCHDOG_PID is absent or ours. @return 0 if it does not.
int64_t service_watchdog_ns(const char* watchdog_usec, const char* watchdog_pid, int64_t own_pid);

}  // namespace roomcal::drivers
