#include "drivers/gige/ipv4.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include <arpa/inet.h>
#include <sys/socket.h>

namespace roomcal::drivers {

namespace {

// The socket calls take the address of any family by this pointer.
const sockaddr* generic(const sockaddr_in& address) { return reinterpret_cast<const sockaddr*>(&address); }

}  // namespace

std::optional<sockaddr_in> ipv4_endpoint(std::string_view address, uint16_t port) {
  std::array<char, INET_ADDRSTRLEN> text{};
  if (address.size() >= text.size()) return std::nullopt;
  std::copy(address.begin(), address.end(), text.begin());
  sockaddr_in endpoint{};
  endpoint.sin_family = AF_INET;
  endpoint.sin_port = htons(port);
  if (::inet_pton(AF_INET, text.data(), &endpoint.sin_addr) != 1) return std::nullopt;
  return endpoint;
}

Result<UniqueFd> open_udp_socket(std::string_view local_address) {
  const auto local = ipv4_endpoint(local_address.empty() ? "0.0.0.0" : local_address, 0);
  if (!local) return Status{StatusCode::kInvalidArgument, "the local address is not an IPv4 address"};
  UniqueFd fd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  if (!fd.valid() || ::setsockopt(fd.get(), SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes) != 0)
    return Status{StatusCode::kUnavailable, "the system gives no datagram socket"};
  if (::bind(fd.get(), generic(*local), sizeof *local) != 0)
    return Status{StatusCode::kUnavailable, "no interface has the local address; bring the network up"};
  return fd;
}

bool send_datagram(int socket, const sockaddr_in& to, std::span<const std::byte> bytes) {
  ssize_t sent = 0;
  int tries = 4;
  do sent = ::sendto(socket, bytes.data(), bytes.size(), 0, generic(to), sizeof to);
  while (sent < 0 && errno == EINTR && --tries > 0);
  return sent == static_cast<ssize_t>(bytes.size());
}

std::span<const std::byte> receive_datagram(int socket, std::span<std::byte> buffer) {
  const ssize_t got = ::recv(socket, buffer.data(), buffer.size(), MSG_DONTWAIT);
  return buffer.first(got > 0 ? static_cast<std::size_t>(got) : 0);
}

}  // namespace roomcal::drivers
