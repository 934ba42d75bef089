#pragma once

#include <array>
#include <cstdint>

#include "runtime/lidar/packet.h"

namespace roomcal::lidar {

/// Where a packet stands among those before it.
enum class PacketOrder : uint8_t {
  kFirst,      ///< nothing to compare with
  kNext,       ///< after the last one
  kLate,       ///< sent before one that came earlier
  kDuplicate,  ///< the same bytes came already
  kRestart,    ///< the clock jumped: another recording or a rebooted sensor
};

struct PacketPlace {
  PacketOrder order = PacketOrder::kFirst;
  int64_t stamp_ns = 0;  ///< of the packet, clock that starts again made continuous
  int64_t after_ns = 0;  ///< since the last packet in order
  uint32_t lost = 0;     ///< packets missing in between, by sequence number, else by the model's pace
  bool in_pace = true;   ///< came at the model's interval; true where the model has none
};

/// Orders packets by their stamps and numbers. About 0.4 kB, no allocation; about 150 ns a packet.
class PacketTracker {
 public:
  PacketPlace place(const PacketHeader& header, Bytes bytes);

 private:
  bool seen(Bytes bytes);
  int64_t since_last(const PacketHeader& header) const;
  uint32_t lost_before(const PacketHeader& header, int64_t after_ns) const;

  std::array<uint64_t, 32> recent_{};  ///< fingerprints
  std::size_t recent_next_ = 0;
  bool any_ = false;
  int64_t last_raw_ns_ = 0, last_ns_ = 0;
  uint32_t last_sequence_ = 0;
};

}  // namespace roomcal::lidar
