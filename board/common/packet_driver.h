#pragma once

#include <cstddef>
#include <span>
#include <variant>

#include "drivers/lidar_udp/udp_packet_source.h"
#include "drivers/replay/replay_packet_source.h"
#include "runtime/profile/profile.h"

namespace roomcal::board {

/// The driver that brings one LiDAR's packets, as the profile chooses it; in place, without a heap.
class PacketDriver {
 public:
  /// Bytes of memory that it wants.
  static std::size_t memory_bytes(const profile::LidarProfile& lidar, const drivers::ReplayCursor& replay);

  /// @param memory  memory_bytes(), outlives the driver.
  void choose(const profile::LidarProfile& lidar, const drivers::ReplayCursor& replay,
              const ports::SystemClocks& clocks, std::span<std::byte> memory);

  ports::PacketSource& source() { return *source_; }
  /// To wait on; -1 where there is nothing to wait on.
  int fd() const;
  /// Its packets come by time: there is nothing to wait on.
  bool replays() const { return std::holds_alternative<drivers::ReplayPacketSource>(driver_); }

 private:
  std::variant<std::monostate, drivers::UdpPacketSource, drivers::ReplayPacketSource> driver_;
  ports::PacketSource* source_ = nullptr;
};

/// "udp", "replay".
const char* to_string(profile::PacketDriver driver);

}  // namespace roomcal::board
