#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include <linux/input.h>

#include "drivers/evdev/reopening_button.h"
#include "drivers/os/device_path.h"
#include "drivers/os/file_kernel.h"
#include "drivers/os/unique_fd.h"

namespace roomcal::drivers {

struct EvdevOptions {
  DevicePath device = {};  ///< "/dev/input/by-path/platform-gpio-keys-event", or a FIFO
  uint16_t key_code = 0;   ///< of linux/input-event-codes.h: KEY_SETUP 141, KEY_POWER 116
};
static_assert(std::is_trivially_copyable_v<EvdevOptions>);

/// A key of a Linux input device (gpio-keys, a USB button), stamped by the kernel on the monotonic clock.
///
/// Where the kernel's queue overflowed (SYN_DROPPED), the key's state is read anew. From a FIFO it reads the same
/// `struct input_event`, so that a script can press; a stamp of zero there means: when it is read.
///
/// start() answers kInvalidArgument without a device or a key code; kNotFound if there is no such device, or it has no
/// such key; kUnavailable if it is no input device.
class EvdevButton final : public ReopeningButton {
 public:
  EvdevButton(const EvdevOptions& options, FileKernel& kernel, const ports::SystemClocks& clocks)
      : ReopeningButton(clocks), options_(options), kernel_(kernel) {}

  int fd() const override { return fd_.get(); }

 private:
  Status open(bool& held) override;
  void close() override { fd_.reset(); }
  bool read(Reading& reading) override;

  Status check() const;
  Status set_up(int fd) const;
  bool is_down(int fd) const;
  bool read_event(input_event& event);
  void judge(const input_event& event, Reading& reading);

  EvdevOptions options_;
  FileKernel& kernel_;
  UniqueFd fd_;
  bool fifo_ = false;
  bool skipping_ = false;  ///< between SYN_DROPPED and the next SYN_REPORT
  std::array<std::byte, sizeof(input_event)> bytes_{};
  std::size_t have_ = 0;  ///< of bytes_: a FIFO may bring an event in pieces
};

}  // namespace roomcal::drivers
