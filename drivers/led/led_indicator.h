#pragma once

#include <cstdint>
#include <string_view>
#include <type_traits>

#include "drivers/os/device_path.h"
#include "drivers/os/file_kernel.h"
#include "runtime/base/fixed_text.h"
#include "runtime/base/status.h"
#include "runtime/ports/indicator.h"

namespace roomcal::drivers {

struct LedOptions {
  DevicePath folder = {};  ///< "/sys/class/leds/status", or any folder: the file `brightness` is made there
};
static_assert(std::is_trivially_copyable_v<LedOptions>);

/// A lamp of Linux's LED class. The kernel's own pattern is taken off at start() and put back at stop(), with the
/// brightness of before. Files are opened for every write, so a lamp whose driver was loaded anew goes on.
class LedIndicator final : public ports::Indicator {
 public:
  LedIndicator(const LedOptions& options, FileKernel& kernel) : options_(options), kernel_(kernel) {}
  ~LedIndicator() override { stop(); }
  LedIndicator(const LedIndicator&) = delete;
  LedIndicator& operator=(const LedIndicator&) = delete;

  /// The lamp is dark then. @return kInvalidArgument without a folder; kUnavailable if there is no such lamp, or it may
  /// not be written.
  Status start();
  /// Writes only what changes. A write that fails is tried again by the next set().
  void set(bool lit) override;
  void stop();

 private:
  using Text = FixedText<31>;
  enum class Shown : uint8_t { kUnknown, kDark, kLit };

  bool show(bool lit);
  long read_file(std::string_view name, std::span<char> into) const;
  bool write_file(std::string_view name, std::string_view text) const;

  LedOptions options_;
  FileKernel& kernel_;
  bool started_ = false;
  Text full_, trigger_before_, brightness_before_;
  Shown shown_ = Shown::kUnknown;
};

}  // namespace roomcal::drivers
