#include "drivers/gpio/gpio_button.h"

#include <cerrno>

#include <linux/gpio.h>

namespace roomcal::drivers {

Status GpioButton::open(bool& held) {
  ROOMCAL_TRY(line_.request_input(options_.line, options_.debounce_us, kernel_));
  if (line_.get(held)) return ok_status();
  line_.release();
  return {StatusCode::kUnavailable, "the button's GPIO line cannot be read"};
}

bool GpioButton::read(Reading& reading) {
  gpio_v2_line_event event{};
  const long got = kernel_.read(line_.fd(), std::as_writable_bytes(std::span(&event, 1)));
  if (got == -EAGAIN) return false;
  if (got != static_cast<long>(sizeof event)) {
    line_.release();
    return false;
  }
  reading = {true, event.id == GPIO_V2_LINE_EVENT_RISING_EDGE, static_cast<int64_t>(event.timestamp_ns)};
  return true;
}

}  // namespace roomcal::drivers
