#include "drivers/watchdog/hardware_watchdog.h"

#include <array>
#include <cerrno>

#include <fcntl.h>
#include <linux/watchdog.h>

#include "drivers/os/c_text.h"

namespace roomcal::drivers {

Status HardwareWatchdog::start() {
  fd_.reset();
  timeout_s_ = 0;
  failed_feeds_ = 0;
  ROOMCAL_TRY(check_path(options_.device));
  if (options_.timeout_s < 1) return {StatusCode::kInvalidArgument, "the watchdog's time must be a second or more"};
  const int fd = kernel_.open(CText(options_.device).c_str(), O_WRONLY);
  if (fd == -EBUSY)
    return {StatusCode::kUnavailable, "somebody else has the watchdog; unset RuntimeWatchdogSec= or the profile's one"};
  if (fd < 0) return {StatusCode::kUnavailable, "there is no watchdog of this name; load its module"};
  fd_ = UniqueFd(fd);
  timeout_s_ = options_.timeout_s;
  const bool set = kernel_.ioctl(fd, WDIOC_SETTIMEOUT, &timeout_s_) >= 0;
  // Some devices cannot be set and tell what they are built for; some round.
  if (kernel_.ioctl(fd, WDIOC_GETTIMEOUT, &timeout_s_) < 0 && !set) timeout_s_ = 0;
  feed();
  if (timeout_s_ * 2 < options_.timeout_s || timeout_s_ > 2 * options_.timeout_s)
    return {StatusCode::kInvalidArgument, "the watchdog cannot be set to the profile's time"};
  return ok_status();
}

/// By writing, which every driver takes; the byte means nothing unless it is the magic one.
void HardwareWatchdog::feed() {
  constexpr std::array kFood = {std::byte{0}};
  if (fd_.valid() && kernel_.write(fd_.get(), kFood) != 1) ++failed_feeds_;
}

void HardwareWatchdog::stop_in_order() {
  constexpr std::array kMagicClose = {std::byte{'V'}};
  if (fd_.valid()) static_cast<void>(kernel_.write(fd_.get(), kMagicClose));
  fd_.reset();
}

}  // namespace roomcal::drivers
