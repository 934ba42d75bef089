#pragma once

#include <cstdint>

#include "drivers/lidar_udp/udp_options.h"
#include "drivers/os/unique_fd.h"
#include "runtime/base/status.h"

namespace roomcal::drivers {

/// Opens the sensor's port: stamps and drop counter on, receive buffer as large as it can be made up to what is needed,
/// bound, group joined. Non-blocking.
/// @param[out] buffer_bytes  what the kernel granted, as it counts; may be less than receive_buffer_bytes().
/// @param[out] joined  number of the interface that the group was joined on; 0 without a group.
/// @return kInvalidArgument for an address that is none; kNotFound while no interface has the name or address;
///         kUnavailable (port taken, kernel too old), each with the remedy. `fd` is then closed.
Status open_udp_socket(const UdpOptions& options, UniqueFd& fd, uint64_t& buffer_bytes, unsigned& joined);

/// Joins the group again where another interface has the name by now: what is unplugged takes its memberships with it,
/// and what is plugged in is a new one. (One that goes down and up again keeps them.) No heap.
/// @param[in,out] joined  as of open_udp_socket(); left alone while there is no interface of that name.
/// @return true if it was joined again.
bool rejoin_group(int fd, const UdpOptions& options, unsigned& joined);

/// The socket's drops so far, modulo 2^32. @return false if the kernel does not tell.
bool read_drops(int fd, uint32_t& drops);

/// @param text  empty: any, 0. @param[out] address  network byte order. @return false if it is no IPv4 address.
bool parse_ipv4(const Ipv4Text& text, uint32_t& address);

}  // namespace roomcal::drivers
