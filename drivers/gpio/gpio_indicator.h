#pragma once

#include "drivers/gpio/gpio_line.h"
#include "runtime/ports/indicator.h"

namespace roomcal::drivers {

/// A lamp on a GPIO line. A write that the kernel refuses is tried again by the next set().
class GpioIndicator final : public ports::Indicator {
 public:
  GpioIndicator(const GpioLineOptions& options, FileKernel& kernel) : options_(options), kernel_(kernel) {}

  /// The lamp is dark then. @return as GpioLine::request_output().
  Status start() { return line_.request_output(options_, kernel_); }
  void set(bool lit) override { static_cast<void>(line_.set(lit)); }
  /// Dark, and given back.
  void stop() {
    set(false);
    line_.release();
  }

 private:
  GpioLineOptions options_;
  FileKernel& kernel_;
  GpioLine line_;
};

}  // namespace roomcal::drivers
