#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/os/unique_fd.h"

namespace roomcal::drivers::test {

inline sockaddr_in ipv4(const char* address, uint16_t port) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(port);
  EXPECT_EQ(::inet_pton(AF_INET, address, &result.sin_addr), 1) << address;
  return result;
}

/// A UDP port that nobody on this host has, another one with every call. Below those that the kernel gives away by
/// itself (ip_local_port_range), so that none of the senders' gets it meanwhile.
inline uint16_t free_port() {
  static int calls = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto port = static_cast<uint16_t>(10'000 + (::getpid() * 37 + ++calls) % 20'000);
    const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM, 0));
    const sockaddr_in address = ipv4("0.0.0.0", port);
    if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return port;
  }
  ADD_FAILURE() << "no free port";
  return 0;
}

/// A LiDAR: sends from an address of this host to a port of it.
class UdpSender {
 public:
  UdpSender(const char* from, const char* to, uint16_t port)
      : fd_(::socket(AF_INET, SOCK_DGRAM, 0)), to_(ipv4(to, port)) {
    sockaddr_in own = ipv4(from, 0);
    EXPECT_EQ(::bind(fd_.get(), reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    ip_mreqn loopback{};
    loopback.imr_ifindex = static_cast<int>(::if_nametoindex("lo"));
    EXPECT_EQ(::setsockopt(fd_.get(), IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback), 0);
    constexpr int kBytes = 1 << 20;
    EXPECT_EQ(::setsockopt(fd_.get(), SOL_SOCKET, SO_SNDBUF, &kBytes, sizeof kBytes), 0);
  }

  bool send(std::span<const std::byte> payload) {
    return ::sendto(fd_.get(), payload.data(), payload.size(), 0, reinterpret_cast<const sockaddr*>(&to_),
                    sizeof to_) == static_cast<ssize_t>(payload.size());
  }

  uint16_t port() const {
    sockaddr_in own{};
    socklen_t size = sizeof own;
    EXPECT_EQ(::getsockname(fd_.get(), reinterpret_cast<sockaddr*>(&own), &size), 0);
    return ntohs(own.sin_port);
  }

 private:
  UniqueFd fd_;
  sockaddr_in to_;
};

}  // namespace roomcal::drivers::test
