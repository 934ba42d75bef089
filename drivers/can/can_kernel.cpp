#include "drivers/can/can_kernel.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <linux/can.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace roomcal::drivers {

namespace {

int or_errno(int result) { return result < 0 ? -errno : result; }

ifreq request_for(const char* name) {
  ifreq request{};
  std::memcpy(request.ifr_name, name, std::min(std::strlen(name), sizeof(request.ifr_name) - 1));
  return request;
}

}  // namespace

int LinuxCanKernel::open_raw() { return or_errno(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)); }

void LinuxCanKernel::close(int fd) { ::close(fd); }

int LinuxCanKernel::interface_index(int fd, const char* name) {
  ifreq request = request_for(name);
  return ::ioctl(fd, SIOCGIFINDEX, &request) < 0 ? -errno : request.ifr_ifindex;
}

int LinuxCanKernel::interface_flags(int fd, const char* name) {
  ifreq request = request_for(name);
  return ::ioctl(fd, SIOCGIFFLAGS, &request) < 0 ? -errno : request.ifr_flags & 0xFFFF;
}

int LinuxCanKernel::interface_mtu(int fd, const char* name) {
  ifreq request = request_for(name);
  return ::ioctl(fd, SIOCGIFMTU, &request) < 0 ? -errno : request.ifr_mtu;
}

int LinuxCanKernel::set_option(int fd, int level, int option, const void* value, std::size_t bytes) {
  return or_errno(::setsockopt(fd, level, option, value, static_cast<socklen_t>(bytes)));
}

int LinuxCanKernel::get_option(int fd, int level, int option, void* value, std::size_t bytes) {
  auto size = static_cast<socklen_t>(bytes);
  return or_errno(::getsockopt(fd, level, option, value, &size));
}

int LinuxCanKernel::bind_to(int fd, int interface_index) {
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = interface_index;
  // NOLINTNEXTLINE: what the socket interface takes
  return or_errno(::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)));
}

long LinuxCanKernel::send(int fd, const void* frame, std::size_t bytes) {
  const ssize_t sent = ::send(fd, frame, bytes, 0);
  return sent < 0 ? -errno : sent;
}

long LinuxCanKernel::receive(int fd, msghdr& into) {
  const ssize_t got = ::recvmsg(fd, &into, 0);
  return got < 0 ? -errno : got;
}

}  // namespace roomcal::drivers
