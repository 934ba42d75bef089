#pragma once

#include <cstdint>

#include "drivers/lidar_udp/udp_options.h"
#include "drivers/os/unique_fd.h"
#include "runtime/base/status.h"

namespace roomcal::drivers {

/// Opens the sensor's port: stamps and drop counter on, receive buffer as large as it can be made up to what is needed,
/// bound, group joined. Non-blocking.
/// @param[out] buffer_bytes  what the kernel granted, as it counts; may be less than receive_buffer_bytes().
/// @return kInvalidArgument for an address that is none; kUnavailable (port taken, no such interface or address, kernel
///         too old), each with the remedy. `fd` is then closed.
Status open_udp_socket(const UdpOptions& options, UniqueFd& fd, uint64_t& buffer_bytes);

/// The socket's drops so far, modulo 2^32. @return false if the kernel does not tell.
bool read_drops(int fd, uint32_t& drops);

/// @param text  empty: any, 0. @param[out] address  network byte order. @return false if it is no IPv4 address.
bool parse_ipv4(const Ipv4Text& text, uint32_t& address);

}  // namespace roomcal::drivers
