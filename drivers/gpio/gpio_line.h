#pragma once

#include <cstdint>
#include <type_traits>

#include "drivers/os/device_path.h"
#include "drivers/os/file_kernel.h"
#include "drivers/os/unique_fd.h"
#include "runtime/base/fixed_text.h"
#include "runtime/base/status.h"

namespace roomcal::drivers {

enum class GpioBias : uint8_t { kAsIs, kPullUp, kPullDown, kOff };

/// One line of a GPIO chip. Chips are numbered as they come up: the line's name in the device tree is what stays.
struct GpioLineOptions {
  FixedText<31> line = {};  ///< "btn-calibrate", as gpioinfo shows it; or its number on `chip`
  DevicePath chip = {};     ///< "/dev/gpiochip0" or a label ("pinctrl-bcm2711"); empty: the name is looked for on all
  bool active_low = false;  ///< a low level is what counts as pressed, lit, fired
  GpioBias bias = GpioBias::kAsIs;
};
static_assert(std::is_trivially_copyable_v<GpioLineOptions>);

/// A line that we hold, by the kernel's GPIO character device (uAPI v2, Linux 5.10). Levels are logical: `active_low`
/// is the kernel's business. No heap.
class GpioLine {
 public:
  /// Both edges are reported, stamped on the monotonic clock, after the level has kept still for `debounce_us`.
  Status request_input(const GpioLineOptions& options, uint32_t debounce_us, FileKernel& kernel);
  /// Not active to begin with.
  Status request_output(const GpioLineOptions& options, FileKernel& kernel);
  /// Of both requests: kInvalidArgument for a line that is neither name nor number of a given chip; kNotFound if there
  /// is no such chip or line; kUnavailable if somebody else holds it, or the chip cannot do what is asked.

  bool held() const { return fd_.valid(); }
  int fd() const { return fd_.get(); }
  void release() { fd_.reset(); }

  /// @return false if the kernel refuses.
  bool get(bool& active) const;
  bool set(bool active) const;

 private:
  Status request(const GpioLineOptions& options, uint64_t flags, uint32_t debounce_us, FileKernel& kernel);

  FileKernel* kernel_ = nullptr;
  UniqueFd fd_;
};

}  // namespace roomcal::drivers
