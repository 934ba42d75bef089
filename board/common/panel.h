#pragma once

#include <optional>
#include <variant>

#include "board/common/files.h"
#include "drivers/evdev/evdev_button.h"
#include "drivers/gpio/gpio_button.h"
#include "drivers/gpio/gpio_indicator.h"
#include "drivers/led/led_indicator.h"
#include "drivers/serial/serial_port.h"
#include "drivers/watchdog/hardware_watchdog.h"
#include "drivers/watchdog/service_notifier.h"
#include "runtime/ports/log.h"
#include "runtime/profile/wiring.h"

namespace roomcal::board {

/// What a person sees and touches, and who is told that all is well: button, lamp, console line, watchdogs. A part that
/// cannot be opened is told and left out: the device works without it.
class Panel {
 public:
  Panel(drivers::FileKernel& kernel, const ports::SystemClocks& clocks, ports::Log& log)
      : kernel_(kernel), clocks_(clocks), log_(log) {}

  void open_console(std::string_view path, uint32_t baud);
  void open(const profile::Wiring& wiring, const Folder& folder);
  /// Tells the service manager and the watchdog that this is an ordered end.
  void close();

  drivers::ReopeningButton* button() { return button_; }
  ports::Indicator* light() { return light_; }
  drivers::SerialPort* console() { return console_ ? &*console_ : nullptr; }
  drivers::ServiceNotifier& service() { return service_; }
  bool has_watchdog() const { return watchdog_.has_value(); }
  int watchdog_timeout_s() const { return watchdog_ ? watchdog_->timeout_s() : 0; }
  void feed();

 private:
  void open_button(const profile::ButtonWiring& wiring, const Folder& folder);
  void open_light(const profile::LightWiring& wiring, const Folder& folder);
  void open_watchdog(const profile::WatchdogWiring& wiring);
  void tell(std::string_view who, Status status);

  drivers::FileKernel& kernel_;
  const ports::SystemClocks& clocks_;
  ports::Log& log_;
  std::variant<std::monostate, drivers::EvdevButton, drivers::GpioButton> buttons_;
  std::variant<std::monostate, drivers::LedIndicator, drivers::GpioIndicator> lights_;
  drivers::ReopeningButton* button_ = nullptr;
  ports::Indicator* light_ = nullptr;
  std::optional<drivers::SerialPort> console_;
  std::optional<drivers::HardwareWatchdog> watchdog_;
  drivers::ServiceNotifier service_;
};

}  // namespace roomcal::board
