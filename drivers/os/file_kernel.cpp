#include "drivers/os/file_kernel.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace roomcal::drivers {

namespace {

constexpr int kMaxInterrupts = 16;

template <typename Call>
auto uninterrupted(const Call& call) {
  auto result = call();
  for (int i = 0; result < 0 && errno == EINTR && i < kMaxInterrupts; ++i) result = call();
  return result < 0 ? static_cast<decltype(result)>(-errno) : result;
}

}  // namespace

int LinuxFileKernel::open(const char* path, int flags) {
  return uninterrupted([&] { return ::open(path, flags | O_CLOEXEC, 0644); });
}

long LinuxFileKernel::read(int fd, std::span<std::byte> into) {
  return uninterrupted([&] { return ::read(fd, into.data(), into.size()); });
}

long LinuxFileKernel::write(int fd, std::span<const std::byte> bytes) {
  return uninterrupted([&] { return ::write(fd, bytes.data(), bytes.size()); });
}

int LinuxFileKernel::ioctl(int fd, unsigned long request, void* argument) {
  return uninterrupted([&] { return ::ioctl(fd, request, argument); });
}

}  // namespace roomcal::drivers
