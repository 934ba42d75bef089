#pragma once

#include <cstdint>

#include "drivers/gpio/gpio_line.h"

namespace roomcal::drivers {

/// Where a line is.
struct GpioPlace {
  UniqueFd chip;
  uint32_t offset = 0;
};

/// Looks through /dev/gpiochip0 to 63, or at the one chip that the options name.
/// @return as GpioLine's requests. `place` only for kOk.
Status find_gpio_line(const GpioLineOptions& options, FileKernel& kernel, GpioPlace& place);

}  // namespace roomcal::drivers
