#include "board/common/panel.h"

#include <cstdlib>

namespace roomcal::board {

void Panel::tell(std::string_view who, Status status) {
  if (!status.ok()) log_.note(who, status.detail());
}

void Panel::open_console(std::string_view path, uint32_t baud) {
  if (path.empty()) return;
  drivers::SerialOptions options;
  options.device = path;
  options.baud = baud;
  console_.emplace(options, kernel_, clocks_);
  tell("console", console_->start());
}

void Panel::open(const profile::Wiring& wiring, const Folder& folder) {
  open_button(wiring.button, folder);
  open_light(wiring.light, folder);
  open_watchdog(wiring.watchdog);
  tell("service", service_.start(std::getenv("NOTIFY_SOCKET")));
}

void Panel::open_button(const profile::ButtonWiring& wiring, const Folder& folder) {
  if (wiring.kind == profile::ButtonKind::kEvdev) {
    drivers::EvdevOptions options;
    options.device = std::string_view(folder.below(wiring.path.view()));
    options.key_code = static_cast<uint16_t>(wiring.code);
    button_ = &buttons_.emplace<drivers::EvdevButton>(options, kernel_, clocks_);
  } else if (wiring.kind == profile::ButtonKind::kLine) {
    drivers::GpioButtonOptions options;
    options.line.chip = wiring.path;
    options.line.line = wiring.line;
    options.line.active_low = wiring.active_low;
    options.debounce_us = wiring.debounce_us;
    button_ = &buttons_.emplace<drivers::GpioButton>(options, kernel_, clocks_);
  }
  if (button_ != nullptr) tell("button", button_->start());
}

void Panel::open_light(const profile::LightWiring& wiring, const Folder& folder) {
  if (wiring.kind == profile::LightKind::kLed) {
    drivers::LedOptions options;
    options.folder = std::string_view(folder.below(wiring.path.view()));
    auto& light = lights_.emplace<drivers::LedIndicator>(options, kernel_);
    tell("light", light.start());
    light_ = &light;
  } else if (wiring.kind == profile::LightKind::kLine) {
    drivers::GpioLineOptions options;
    options.chip = wiring.path;
    options.line = wiring.line;
    options.active_low = wiring.active_low;
    auto& light = lights_.emplace<drivers::GpioIndicator>(options, kernel_);
    tell("light", light.start());
    light_ = &light;
  }
}

void Panel::open_watchdog(const profile::WatchdogWiring& wiring) {
  if (wiring.path.empty()) return;
  drivers::WatchdogOptions options;
  options.device = wiring.path;
  options.timeout_s = static_cast<int>(wiring.timeout_s);
  watchdog_.emplace(options, kernel_);
  tell("watchdog", watchdog_->start());
}

void Panel::feed() {
  service_.feed();
  if (watchdog_) watchdog_->feed();
}

void Panel::close() {
  if (light_ != nullptr) light_->set(false);
  service_.stopping();
  if (watchdog_) watchdog_->stop_in_order();
}

}  // namespace roomcal::board
