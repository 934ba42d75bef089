#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <netinet/in.h>
#include <sys/socket.h>

#include "drivers/gige/ipv4.h"
#include "drivers/os/linux_clocks.h"
#include "drivers/os/wait.h"

namespace roomcal::drivers {

/// A socket that stands where a camera would, on a port of its own.
class UdpPeer {
 public:
  /// @param port  0: a free one. Several peers may share one, as cameras do.
  explicit UdpPeer(std::string_view address = "127.0.0.1", uint16_t port = 0) {
    const auto at = ipv4_endpoint(address, port);
    fd_ = UniqueFd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const int yes = 1;
    ::setsockopt(fd_.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    socklen_t size = sizeof at_;
    if (::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&*at), sizeof *at) != 0 ||
        ::getsockname(fd_.get(), reinterpret_cast<sockaddr*>(&at_), &size) != 0)
      throw std::runtime_error("no socket for a test");
  }

  uint16_t port() const { return ntohs(at_.sin_port); }
  sockaddr_in endpoint() const { return at_; }

  /// The next datagram; empty after `wait_ns` without one.
  std::vector<std::byte> receive(int64_t wait_ns = 2'000'000'000) {
    const std::array<int, 1> fds{fd_.get()};
    if (wait_readable(fds, LinuxClocks().now_ns() + wait_ns) == 0) return {};
    std::vector<std::byte> bytes(2048);
    socklen_t size = sizeof sender_;
    const ssize_t got =
        ::recvfrom(fd_.get(), bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&sender_), &size);
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }
  /// To whoever sent the last one.
  void answer(std::span<const std::byte> bytes) { send_datagram(fd_.get(), sender_, bytes); }

 private:
  UniqueFd fd_;
  sockaddr_in at_{};
  sockaddr_in sender_{};
};

/// An acknowledgement to `command`, as a camera makes it.
inline std::vector<std::byte> acknowledge(std::span<const std::byte> command, uint16_t status,
                                          std::span<const std::byte> payload = {}) {
  const auto low = [](std::size_t value) { return static_cast<std::byte>(value & 0xFF); };
  const std::array head{low(status >> 8U),         low(status),         command[2], command[3] | std::byte{1},
                        low(payload.size() >> 8U), low(payload.size()), command[6], command[7]};
  std::vector<std::byte> ack(head.size() + payload.size());
  std::copy(payload.begin(), payload.end(), std::copy(head.begin(), head.end(), ack.begin()));
  return ack;
}

}  // namespace roomcal::drivers
