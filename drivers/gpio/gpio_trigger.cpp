#include "drivers/gpio/gpio_trigger.h"

namespace roomcal::drivers {

Status GpioTrigger::start() {
  active_ = false;
  return line_.request_output(options_.line, kernel_);
}

Status GpioTrigger::fire() {
  if (active_ && !line_.set(false))
    return {StatusCode::kUnavailable, "the trigger's GPIO line cannot be taken back; check its chip"};
  active_ = line_.set(true);
  if (!active_) return {StatusCode::kUnavailable, "the trigger's GPIO line cannot be set; check its chip"};
  clocks_.sleep_until(clocks_.now_ns() + int64_t{options_.pulse_us} * 1000);
  active_ = !line_.set(false);
  return ok_status();
}

}  // namespace roomcal::drivers
