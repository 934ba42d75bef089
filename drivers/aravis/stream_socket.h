#pragma once

#include <cstddef>
#include <cstdint>

namespace roomcal::drivers {

/// Gives the datagram socket of this process that is bound to `port` a receive buffer of `bytes` bytes. Aravis would
/// ask for it when the first packet of the first image is there, and for no more than net.core.rmem_max; with
/// CAP_NET_ADMIN that limit does not hold.
/// @return what the kernel granted; 0 if no socket has that port.
std::size_t widen_receive_buffer(uint16_t port, std::size_t bytes);

}  // namespace roomcal::drivers
