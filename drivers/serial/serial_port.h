#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include <termios.h>

#include "drivers/os/device_path.h"
#include "drivers/os/file_kernel.h"
#include "drivers/os/retry.h"
#include "drivers/os/unique_fd.h"
#include "runtime/base/status.h"
#include "runtime/ports/byte_sink.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

struct SerialOptions {
  DevicePath device = {};   ///< "/dev/ttyS0", "/dev/serial/by-path/...", a pty; "-": standard input and output
  uint32_t baud = 115'200;  ///< 9600 to 3000000; unused for "-"
};
static_assert(std::is_trivially_copyable_v<SerialOptions>);

/// The console's line: bytes in, bytes out, never waiting. A line that vanishes (a USB adapter) is opened again by its
/// path, once a second, without end. Standard input and output are opened anew, so that nobody else's become
/// non-blocking; a terminal is made raw, but for Ctrl-C, and given back at stop(). The program ignores SIGPIPE.
class SerialPort final : public ports::ByteSink {
 public:
  SerialPort(const SerialOptions& options, FileKernel& kernel, const ports::SystemClocks& clocks)
      : options_(options), kernel_(kernel), clocks_(clocks) {}
  ~SerialPort() override { stop(); }
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  /// @return kInvalidArgument for a path or rate that is none; kUnsupported for what is no serial line; kUnavailable if
  /// it
  ///         cannot be opened. Except for kInvalidArgument it goes on trying.
  Status start();
  /// What has come. @return how many bytes; 0: none now.
  std::size_t read_some(std::span<char> into);
  std::size_t write_some(std::span<const char> bytes) override;
  void stop();

  /// To wait on; -1 while it is not there, or stopped, or at the end of standard input.
  int fd() const { return in_.get(); }
  /// How often the line has vanished since start().
  uint64_t times_lost() const { return times_lost_; }

 private:
  bool standard() const { return options_.device.view() == "-"; }
  Status open();
  Status open_standard();
  bool there();
  void lose();

  SerialOptions options_;
  FileKernel& kernel_;
  const ports::SystemClocks& clocks_;
  UniqueFd in_, out_;  ///< out_: of standard output only
  Retry retry_;
  bool wanted_ = false;  ///< to be opened again when it has gone
  bool give_back_ = false;
  termios before_{};
  uint64_t times_lost_ = 0;
};

}  // namespace roomcal::drivers
