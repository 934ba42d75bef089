#pragma once

#include <cstdint>
#include <type_traits>

#include "drivers/gpio/gpio_line.h"
#include "runtime/ports/system_clocks.h"
#include "runtime/ports/trigger.h"

namespace roomcal::drivers {

struct GpioTriggerOptions {
  GpioLineOptions line = {};
  uint32_t pulse_us = 1000;  ///< cameras debounce their inputs: some want a millisecond
};
static_assert(std::is_trivially_copyable_v<GpioTriggerOptions>);

/// A pulse on the line that all cameras' trigger inputs hang on.
class GpioTrigger final : public ports::Trigger {
 public:
  GpioTrigger(const GpioTriggerOptions& options, FileKernel& kernel, const ports::SystemClocks& clocks)
      : options_(options), kernel_(kernel), clocks_(clocks) {}

  /// The line is not active then. @return as GpioLine::request_output().
  Status start();
  const char* name() const override { return "line"; }
  /// Takes as long as the pulse. A line that could not be taken back after it has fired; the next call takes it back
  /// first, or fails.
  Status fire() override;
  void stop() { line_.release(); }

 private:
  GpioTriggerOptions options_;
  FileKernel& kernel_;
  const ports::SystemClocks& clocks_;
  GpioLine line_;
  bool active_ = false;
};

}  // namespace roomcal::drivers
