#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include <netinet/in.h>

#include "drivers/os/unique_fd.h"
#include "runtime/base/status.h"

/// The few calls that GVCP needs of an IPv4 datagram socket. None takes heap.
namespace roomcal::drivers {

/// @return nothing for a text that is not a dotted IPv4 address.
std::optional<sockaddr_in> ipv4_endpoint(std::string_view address, uint16_t port);

/// A socket that may broadcast, bound to a local address (empty: any; on Linux a broadcast to 255.255.255.255 leaves
/// through the interface of that address) and a port of the system's choice.
/// @return kInvalidArgument for an address that is none, kUnavailable if no interface has it.
Result<UniqueFd> open_udp_socket(std::string_view local_address);

/// @return false if the kernel did not take it whole.
bool send_datagram(int socket, const sockaddr_in& to, std::span<const std::byte> bytes);

/// Does not wait. @return the datagram, in `buffer`; empty if there is none.
std::span<const std::byte> receive_datagram(int socket, std::span<std::byte> buffer);

}  // namespace roomcal::drivers
