#include "drivers/lidar_udp/udp_socket.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>

#include <arpa/inet.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "drivers/os/c_text.h"

namespace roomcal::drivers {

namespace {

Status unavailable(const char* detail) { return {StatusCode::kUnavailable, detail}; }
Status not_there(const char* detail) { return {StatusCode::kNotFound, detail}; }

template <typename Value>
bool set_option(int fd, int level, int name, const Value& value) {
  return ::setsockopt(fd, level, name, &value, sizeof value) == 0;
}

Status check(const UdpOptions& options) {
  uint32_t address = 0;
  if (options.port == 0) return {StatusCode::kInvalidArgument, "the LiDAR's port is 0; name the one that it sends to"};
  if (options.max_payload == 0 || options.max_payload > 65507)
    return {StatusCode::kInvalidArgument, "the LiDAR's longest packet must be 1 to 65507 bytes"};
  if (!parse_ipv4(options.local, address) || !parse_ipv4(options.sender, address))
    return {StatusCode::kInvalidArgument, "an address of the LiDAR's port is no IPv4 address"};
  if (options.group.empty()) return ok_status();
  if (!parse_ipv4(options.group, address) || !IN_MULTICAST(ntohl(address)))
    return {StatusCode::kInvalidArgument, "the LiDAR's group is no multicast address (224.0.0.0 to 239.255.255.255)"};
  if (options.interface.empty())
    return {StatusCode::kInvalidArgument, "a multicast group needs the name of the interface towards the LiDAR"};
  return ok_status();
}

// With 64-bit seconds on every processor, whatever time_t is.
Status turn_on_accounting(int fd) {
  uint32_t drops = 0;
  if (!set_option(fd, SOL_SOCKET, SO_TIMESTAMPNS_NEW, 1) || !set_option(fd, SOL_SOCKET, SO_RXQ_OVFL, 1) ||
      !read_drops(fd, drops))
    return unavailable("the kernel does not stamp packets and count drops; it must be Linux 5.1 or newer");
  return ok_status();
}

// The kernel doubles what it is asked for, and counts against the double. FORCE may pass net.core.rmem_max.
uint64_t grow_receive_buffer(int fd, uint64_t bytes) {
  constexpr uint64_t kMost = std::numeric_limits<int>::max() / 2;
  const auto half = static_cast<int>(std::min(bytes / 2 + 1, kMost));
  if (!set_option(fd, SOL_SOCKET, SO_RCVBUFFORCE, half)) static_cast<void>(set_option(fd, SOL_SOCKET, SO_RCVBUF, half));
  int granted = 0;
  socklen_t size = sizeof granted;
  if (::getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &granted, &size) != 0) return 0;
  return static_cast<uint64_t>(std::max(granted, 0));
}

// A group's socket is bound to the group, so that nothing else comes through it, and shares its port with whoever else
// listens to the group. Others own their port, so that a second owner is noticed.
Status bind_port(int fd, const UdpOptions& options) {
  const bool multicast = !options.group.empty();
  if (multicast && !set_option(fd, SOL_SOCKET, SO_REUSEADDR, 1))
    return unavailable("the LiDAR's port cannot be shared");
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(options.port);
  static_cast<void>(parse_ipv4(multicast ? options.group : options.local, address.sin_addr.s_addr));
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return ok_status();
  if (errno == EADDRINUSE) return unavailable("the LiDAR's port is taken; stop the other program that listens to it");
  if (errno == EADDRNOTAVAIL)
    return not_there("no interface has the address of the LiDAR's port; set it up or leave the address out");
  if (errno == EACCES) return unavailable("ports below 1024 need CAP_NET_BIND_SERVICE; set another one in the LiDAR");
  return unavailable("the LiDAR's port cannot be bound");
}

unsigned interface_number(const UdpOptions& options) { return ::if_nametoindex(CText(options.interface).c_str()); }

bool change_membership(int fd, int change, const UdpOptions& options, unsigned interface) {
  ip_mreqn request{};
  static_cast<void>(parse_ipv4(options.group, request.imr_multiaddr.s_addr));
  request.imr_ifindex = static_cast<int>(interface);
  return set_option(fd, IPPROTO_IP, change, request);
}

Status join_group(int fd, const UdpOptions& options, unsigned& joined) {
  joined = 0;
  if (options.group.empty()) return ok_status();
  const unsigned interface = interface_number(options);
  if (interface == 0) return not_there("no interface of the LiDAR's name; see `ip link`");
  // Without this, groups that other programs joined come through our socket too.
  if (!set_option(fd, IPPROTO_IP, IP_MULTICAST_ALL, 0) || !change_membership(fd, IP_ADD_MEMBERSHIP, options, interface))
    return unavailable("the LiDAR's multicast group cannot be joined on its interface");
  joined = interface;
  return ok_status();
}

Status set_up(int fd, const UdpOptions& options, uint64_t& buffer_bytes, unsigned& joined) {
  ROOMCAL_TRY(turn_on_accounting(fd));
  buffer_bytes = grow_receive_buffer(fd, receive_buffer_bytes(options));
  ROOMCAL_TRY(bind_port(fd, options));
  return join_group(fd, options, joined);
}

}  // namespace

bool parse_ipv4(const Ipv4Text& text, uint32_t& address) {
  address = 0;
  return text.empty() || ::inet_pton(AF_INET, CText(text).c_str(), &address) == 1;
}

bool read_drops(int fd, uint32_t& drops) {
  std::array<uint32_t, SK_MEMINFO_VARS> info{};
  socklen_t size = sizeof info;
  if (::getsockopt(fd, SOL_SOCKET, SO_MEMINFO, info.data(), &size) != 0) return false;
  drops = info[SK_MEMINFO_DROPS];
  return size > SK_MEMINFO_DROPS * sizeof(uint32_t);
}

Status open_udp_socket(const UdpOptions& options, UniqueFd& fd, uint64_t& buffer_bytes, unsigned& joined) {
  fd.reset();
  ROOMCAL_TRY(check(options));
  UniqueFd fresh(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!fresh.valid()) return unavailable("the system has no socket left; raise LimitNOFILE= of the service");
  ROOMCAL_TRY(set_up(fresh.get(), options, buffer_bytes, joined));
  fd = std::move(fresh);
  return ok_status();
}

bool rejoin_group(int fd, const UdpOptions& options, unsigned& joined) {
  if (options.group.empty()) return false;
  const unsigned interface = interface_number(options);
  if (interface == 0 || interface == joined) return false;
  // A socket takes twenty memberships, also those on interfaces that are gone.
  static_cast<void>(change_membership(fd, IP_DROP_MEMBERSHIP, options, joined));
  if (!change_membership(fd, IP_ADD_MEMBERSHIP, options, interface)) return false;
  joined = interface;
  return true;
}

}  // namespace roomcal::drivers
