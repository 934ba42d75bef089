#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/lidar_udp/drop_count.h"
#include "drivers/lidar_udp/udp_options.h"
#include "drivers/os/unique_fd.h"
#include "runtime/ports/packet_source.h"

namespace roomcal::drivers {

/// A LiDAR's packets from its UDP port, every one of them accounted for: sent = delivered + kernel_drops + truncated +
/// foreign, as far as they reached this host.
///
/// Packets are stamped by the kernel when they arrive (ClockId::kRealtime). The sender is compared here and not by
/// connect() or a socket filter: the first would hide foreign packets, the second count them as drops.
class UdpPacketSource final : public ports::PacketSource {
 public:
  /// Packets that one system call takes, and the most that one drain() hands over.
  static constexpr std::size_t kBatch = 32, kMaxDrain = 64 * kBatch;

  /// Bytes that the source wants: about 32 packets of the longest kind and 5 kB.
  static std::size_t memory_bytes(const UdpOptions& options);

  /// @param memory  must outlive the source.
  UdpPacketSource(const UdpOptions& options, std::span<std::byte> memory) : options_(options), memory_(memory) {}

  std::string_view name() const override { return options_.name.view(); }
  /// Where the interface or address that it listens on is missing, drain() looks for it twice a second.
  /// @return also kOutOfMemory if the memory is smaller than memory_bytes(), and kUnavailable if the kernel grants a
  ///         smaller receive buffer than the sensor needs; the text then names the sysctl with its value and lives as
  ///         long as the source.
  Status start() override;
  std::size_t drain(ports::PacketVisitor& visitor) override;
  void stop() override;
  const ports::PacketCounters& counters() const override { return counters_; }

  /// To wait on; -1 while stopped, or while its interface is missing.
  int fd() const { return fd_.get(); }
  /// What the kernel granted, as it counts.
  uint64_t receive_buffer() const { return buffer_bytes_; }

 private:
  struct Slots;
  enum class Fate : uint8_t { kDelivered, kTruncated, kForeign };

  Status open();
  Status lay_out();
  Status refuse_buffer();
  int receive();
  void ready(std::size_t slot);
  Fate fate_of(std::size_t slot) const;
  bool take(std::size_t slot, ports::PacketVisitor& visitor);
  Stamp read_control(std::size_t slot);
  void read_socket_drops();
  void look_at_interface();

  UdpOptions options_;
  std::span<std::byte> memory_;
  UniqueFd fd_;
  Slots* slots_ = nullptr;
  std::byte* payloads_ = nullptr;
  uint32_t sender_ = 0;  ///< network byte order; 0: anybody
  uint64_t buffer_bytes_ = 0;
  unsigned joined_ = 0;  ///< number of the interface that the group was joined on; 0: there is no group
  int64_t looked_ns_ = 0;
  bool wanted_ = false;  ///< it was started, and goes on looking where its interface is missing
  DropCount drops_;
  ports::PacketCounters counters_;
  std::array<char, 160> detail_{};
};

}  // namespace roomcal::drivers
