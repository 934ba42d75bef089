#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "drivers/replay/replay_cursor.h"
#include "runtime/lidar/pcap.h"
#include "runtime/ports/packet_source.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::drivers {

struct ReplayPacketOptions {
  SensorName name = {};            ///< the file is `<name>.pcap`
  uint16_t port = 0;               ///< UDP port of the sensor's data packets; 0: packets to any port
  int64_t turn_ns = 100'000'000;   ///< one turn of the sensor: loops are whole turns. 0: loops are whole recordings
  int64_t stall_ns = 100'000'000;  ///< how long a packet waits for the reader before it counts as dropped
};
static_assert(std::is_trivially_copyable_v<ReplayPacketOptions>);

/// A LiDAR that sends the recorded packets of a folder, one pcap a shot, at the recording's own pace and over and over.
/// Packets are stamped on the monotonic clock with the time when they are due. A loop ends after whole turns, so the
/// head goes on where it was; the sensor's own clock, which is in its packets, is set back there, and
/// lidar::SweepBuilder starts a sweep anew.
class ReplayPacketSource final : public ports::PacketSource {
 public:
  static constexpr std::size_t kMaxDrain = 2048;  ///< packets that one drain() looks at

  /// Bytes that the source wants: the recordings of all shots as they are on the disk, and 90 kB.
  static std::size_t memory_bytes(const ReplayPacketOptions& options, const ReplayCursor& cursor);

  /// @param memory  for the recordings, read at start(). All references must outlive the source.
  ReplayPacketSource(const ReplayPacketOptions& options, const ReplayCursor& cursor, const ports::SystemClocks& clocks,
                     std::span<std::byte> memory)
      : options_(options), cursor_(cursor), clocks_(clocks), memory_(memory) {}

  std::string_view name() const override { return options_.name.view(); }
  /// @return kUnavailable if a recording is missing, cannot be read, is no pcap or holds no packet to the port;
  ///         kOutOfMemory if the memory is smaller than memory_bytes().
  Status start() override;
  std::size_t drain(ports::PacketVisitor& visitor) override;
  void stop() override { shots_ = {}; }
  const ports::PacketCounters& counters() const override { return counters_; }

 private:
  struct Shot {
    lidar::PcapReader reader;
    int64_t first_ns = 0;  ///< arrival of its first packet, recorder's clock
    int64_t loop_ns = 0;   ///< packets from here on are not played
    uint64_t packets = 0;  ///< of one loop
  };

  Status load();
  Status load_shot(int shot, std::span<std::byte>& free, lidar::IpFragments& fragments);
  Status measure(Shot& shot) const;
  bool next_of(Shot& shot, lidar::Datagram& datagram) const;
  void follow(const ReplayCursor::Place& place);
  void skip_loops(int64_t now_ns);
  bool fetch();

  ReplayPacketOptions options_;
  const ReplayCursor& cursor_;
  const ports::SystemClocks& clocks_;
  std::span<std::byte> memory_;
  std::span<Shot> shots_;
  ReplayCursor::Place place_;
  int64_t loop_start_ns_ = 0;  ///< monotonic
  lidar::Datagram next_;
  bool have_next_ = false;
  ports::PacketCounters counters_;
};

}  // namespace roomcal::drivers
