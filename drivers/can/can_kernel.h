#pragma once

#include <cstddef>

#include <sys/socket.h>

namespace roomcal::drivers {

/// The system calls of a CAN socket, so that a test can stand in for the kernel. All return what the call returns, or
/// -errno.
class CanKernel {
 public:
  virtual ~CanKernel() = default;

  /// A raw CAN socket that does not block.
  virtual int open_raw() = 0;
  virtual void close(int fd) = 0;
  /// Number, IFF_ flags and MTU of a network interface by its name, shorter than IFNAMSIZ.
  virtual int interface_index(int fd, const char* name) = 0;
  virtual int interface_flags(int fd, const char* name) = 0;
  virtual int interface_mtu(int fd, const char* name) = 0;
  virtual int set_option(int fd, int level, int option, const void* value, std::size_t bytes) = 0;
  virtual int get_option(int fd, int level, int option, void* value, std::size_t bytes) = 0;
  virtual int bind_to(int fd, int interface_index) = 0;
  virtual long send(int fd, const void* frame, std::size_t bytes) = 0;
  virtual long receive(int fd, msghdr& into) = 0;
};

/// The kernel itself.
class LinuxCanKernel final : public CanKernel {
 public:
  int open_raw() override;
  void close(int fd) override;
  int interface_index(int fd, const char* name) override;
  int interface_flags(int fd, const char* name) override;
  int interface_mtu(int fd, const char* name) override;
  int set_option(int fd, int level, int option, const void* value, std::size_t bytes) override;
  int get_option(int fd, int level, int option, void* value, std::size_t bytes) override;
  int bind_to(int fd, int interface_index) override;
  long send(int fd, const void* frame, std::size_t bytes) override;
  long receive(int fd, msghdr& into) override;
};

}  // namespace roomcal::drivers
