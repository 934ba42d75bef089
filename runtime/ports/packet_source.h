#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "runtime/base/status.h"
#include "runtime/base/time.h"

namespace roomcal::ports {

/// One datagram of a sensor.
struct Packet {
  std::span<const std::byte> payload;  ///< lives until the visitor returns
  Stamp arrived;                       ///< as the kernel stamped it, or the recording
};

/// Takes packets one by one, in the order of their arrival.
class PacketVisitor {
 public:
  virtual ~PacketVisitor() = default;
  virtual void take(const Packet& packet) = 0;
};

/// Since start(); monotone. Whatever was sent is either in `delivered` or in one of the others, as far as the kernel
/// can know: what was lost on the wire only the sensor's own numbers tell (lidar::SweepBuilder).
struct PacketCounters {
  uint64_t delivered = 0;
  uint64_t kernel_drops = 0;  ///< the socket's buffer was full
  uint64_t truncated = 0;     ///< longer than any packet of a LiDAR
  uint64_t foreign = 0;       ///< from another sender than the profile names
  uint64_t errors = 0;        ///< receive calls that failed; `error_number` is the last one's
  int error_number = 0;
};

/// The data port of one LiDAR. All calls from the one thread that owns it.
class PacketSource {
 public:
  virtual ~PacketSource() = default;

  /// As in the profile, for messages.
  virtual std::string_view name() const = 0;

  /// Opens the port and reserves all that it will ever need. Before arming.
  /// @return kOk; kNotFound if what it listens on is not there yet: drain() then goes on looking for it; kUnavailable
  ///         (port taken) or kInvalidArgument (an address that is none) with the remedy.
  virtual Status start() = 0;

  /// Hands over every packet that has arrived, up to a bound; does not wait.
  /// @return how many. No heap.
  virtual std::size_t drain(PacketVisitor& visitor) = 0;

  virtual void stop() = 0;
  virtual const PacketCounters& counters() const = 0;
};

}  // namespace roomcal::ports
