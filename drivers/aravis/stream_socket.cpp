#include "drivers/aravis/stream_socket.h"

#include <algorithm>
#include <climits>

#include <netinet/in.h>
#include <sys/socket.h>

namespace roomcal::drivers {

namespace {

constexpr int kMostDescriptors = 4096;  // Aravis does not tell its own

bool is_bound_to(int fd, uint16_t port) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  int type = 0;
  socklen_t type_size = sizeof type;
  // getsockname() takes the address of any family by this pointer.
  return ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0 && address.sin_family == AF_INET &&
         ntohs(address.sin_port) == port && ::getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &type_size) == 0 &&
         type == SOCK_DGRAM;
}

std::size_t widen(int fd, std::size_t bytes) {
  const int wanted = static_cast<int>(std::min<std::size_t>(bytes, INT_MAX / 2));
  if (::setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof wanted) != 0)
    ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
  int granted = 0;
  socklen_t size = sizeof granted;
  ::getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted, &size);
  return static_cast<std::size_t>(granted) / 2;  // the kernel tells twice of what it was asked for
}

}  // namespace

std::size_t widen_receive_buffer(uint16_t port, std::size_t bytes) {
  for (int fd = 0; fd < kMostDescriptors; ++fd)
    if (is_bound_to(fd, port)) return widen(fd, bytes);
  return 0;
}

}  // namespace roomcal::drivers
