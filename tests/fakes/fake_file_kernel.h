#pragma once

#include <array>
#include <cerrno>
#include <cstdint>
#include <functional>

#include <fcntl.h>

#include "drivers/os/file_kernel.h"

namespace roomcal::fakes {

/// The real kernel, but for what a test takes over: opening, control calls, and scripted faults.
class FakeFileKernel final : public drivers::FileKernel {
 public:
  enum class Call : uint8_t { kOpen, kRead, kWrite, kIoctl, kCount };

  /// This call fails so many times, from its n-th on (counted from 0 since fail()).
  void fail(Call call, int at, int times, int error_number) {
    counts_ = {};
    faulty_ = call;
    first_ = at;
    times_ = times;
    error_ = error_number;
  }
  void heal() { fail(Call::kCount, 0, 0, 0); }
  int count(Call call) const { return counts_[static_cast<std::size_t>(call)]; }

  /// In place of open() and ioctl(); they return what the call returns, or -errno. Empty: the real one.
  std::function<int(const char*, int)> on_open;
  std::function<int(int, unsigned long, void*)> on_ioctl;

  int open(const char* path, int flags) override {
    if (const int error = scripted(Call::kOpen); error != 0) return -error;
    return on_open ? on_open(path, flags) : real_.open(path, flags);
  }
  long read(int fd, std::span<std::byte> into) override {
    if (const int error = scripted(Call::kRead); error != 0) return -error;
    return real_.read(fd, into);
  }
  long write(int fd, std::span<const std::byte> bytes) override {
    if (const int error = scripted(Call::kWrite); error != 0) return -error;
    return real_.write(fd, bytes);
  }
  int ioctl(int fd, unsigned long request, void* argument) override {
    if (const int error = scripted(Call::kIoctl); error != 0) return -error;
    return on_ioctl ? on_ioctl(fd, request, argument) : real_.ioctl(fd, request, argument);
  }

  /// What on_open returns for a device whose far end the test holds: a descriptor of its own, without waiting.
  static int share(int fd) {
    const int copy = ::fcntl(fd, F_DUPFD_CLOEXEC, 0);
    if (copy >= 0) static_cast<void>(::fcntl(copy, F_SETFL, ::fcntl(copy, F_GETFL) | O_NONBLOCK));
    return copy >= 0 ? copy : -errno;
  }

 private:
  int scripted(Call call) {
    const int n = counts_[static_cast<std::size_t>(call)]++;
    return call == faulty_ && n >= first_ && n - first_ < times_ ? error_ : 0;
  }

  drivers::LinuxFileKernel real_;
  Call faulty_ = Call::kCount;
  int first_ = 0, times_ = 0, error_ = 0;
  std::array<int, static_cast<std::size_t>(Call::kCount)> counts_{};
};

}  // namespace roomcal::fakes
