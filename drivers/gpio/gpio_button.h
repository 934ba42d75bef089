#pragma once

#include <cstdint>
#include <type_traits>

#include "drivers/evdev/reopening_button.h"
#include "drivers/gpio/gpio_line.h"

namespace roomcal::drivers {

struct GpioButtonOptions {
  GpioLineOptions line = {};
  uint32_t debounce_us = 10'000;  ///< contacts of buttons bounce for some milliseconds
};
static_assert(std::is_trivially_copyable_v<GpioButtonOptions>);

/// A button on a GPIO line, where the device tree has no gpio-keys for it. Debounced and stamped by the kernel; its
/// queue drops the oldest edges when it overflows, so the last ones tell the present state. start() answers as
/// GpioLine::request_input().
class GpioButton final : public ReopeningButton {
 public:
  GpioButton(const GpioButtonOptions& options, FileKernel& kernel, const ports::SystemClocks& clocks)
      : ReopeningButton(clocks), options_(options), kernel_(kernel) {}

  int fd() const override { return line_.fd(); }

 private:
  Status open(bool& held) override;
  void close() override { line_.release(); }
  bool read(Reading& reading) override;

  GpioButtonOptions options_;
  FileKernel& kernel_;
  GpioLine line_;
};

}  // namespace roomcal::drivers
