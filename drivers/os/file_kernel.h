#pragma once

#include <cstddef>
#include <span>

namespace roomcal::drivers {

/// The system calls of drivers that work on device files; tests script their faults. All return what the call returns,
/// or -errno. A call that a signal interrupts is taken up again. No heap.
class FileKernel {
 public:
  virtual ~FileKernel() = default;
  /// Always close-on-exec. @return a descriptor, which its UniqueFd closes.
  virtual int open(const char* path, int flags) = 0;
  virtual long read(int fd, std::span<std::byte> into) = 0;
  virtual long write(int fd, std::span<const std::byte> bytes) = 0;
  virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
};

/// The kernel that runs. Any thread; no state.
class LinuxFileKernel final : public FileKernel {
 public:
  int open(const char* path, int flags) override;
  long read(int fd, std::span<std::byte> into) override;
  long write(int fd, std::span<const std::byte> bytes) override;
  int ioctl(int fd, unsigned long request, void* argument) override;
};

}  // namespace roomcal::drivers
