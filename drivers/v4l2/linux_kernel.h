#pragma once

#include "drivers/v4l2/kernel.h"

namespace roomcal::drivers {

/// The kernel that runs. Any thread; no state. No heap: directories are read by getdents64, not by the C library.
class LinuxV4l2Kernel final : public V4l2Kernel {
 public:
  /// @param sys  where sysfs is, outlives this; tests bring a folder of their own.
  explicit LinuxV4l2Kernel(std::string_view sys = "/sys") : sys_(sys) {}

  int open(std::string_view node) override;
  void close(int fd) override;
  int ioctl(int fd, unsigned long request, void* argument) override;
  int map(int fd, std::size_t size, int64_t offset, std::span<const std::byte>& bytes) override;
  void unmap(std::span<const std::byte> bytes) override;
  int poll(int fd, int64_t timeout_ns) override;
  int list(std::span<NodeName> names) override;
  int describe(std::string_view name, VideoNode& node) override;
  int read_link(std::string_view path, FixedText<255>& target) override;
  int reset_usb_device(std::string_view device) override;

 private:
  std::string_view sys_;
};

}  // namespace roomcal::drivers
