#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "runtime/base/fixed_text.h"

namespace roomcal::drivers {

using Ipv4Text = FixedText<15>;       ///< "192.168.1.201"
using InterfaceName = FixedText<15>;  ///< "eth1"

/// The data port of one LiDAR. Plain memory: a board's binary profile fills it.
struct UdpOptions {
  SensorName name = {};
  uint16_t port = 0;             ///< that the sensor sends to: 2368 for most
  Ipv4Text local = {};           ///< own address; empty: all of them, which a sensor that broadcasts needs
  Ipv4Text group = {};           ///< multicast group that the sensor sends to; empty: it sends to us or broadcasts
  InterfaceName interface = {};  ///< towards the sensor; must be named with a group
  Ipv4Text sender = {};          ///< the sensor's address; packets of others are dropped and counted. Empty: anybody's
  uint16_t sender_port = 0;      ///< the port that it sends from; 0: any
  uint32_t max_payload = 1472;   ///< bytes of the sensor's longest packet; longer ones are dropped and counted
  uint32_t packets_per_second = 0;  ///< at its highest rate: VLP-16 754, 1508 in dual return
  uint32_t stall_ms = 100;          ///< the longest that the reading thread may stay away without a loss
};
static_assert(std::is_trivially_copyable_v<UdpOptions>);

/// Bytes of receive buffer that the sensor needs: its packets of one stall, as the kernel charges them.
///
/// The kernel counts what a packet occupies, not its payload (measured by SO_MEMINFO on Linux 6.1 to 6.18): 2304 bytes
/// up to 1472 of payload, then below twice the payload and 1536 more, in fragments as over loopback.
constexpr uint64_t receive_buffer_bytes(const UdpOptions& options) {
  const uint64_t packet = options.max_payload <= 1472 ? 2304 : 2 * uint64_t{options.max_payload} + 1536;
  return (uint64_t{options.packets_per_second} * options.stall_ms / 1000 + 1) * packet;
}

}  // namespace roomcal::drivers
