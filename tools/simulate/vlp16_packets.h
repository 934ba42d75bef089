#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/lidar/velodyne.h"

namespace roomcal::tools {

/// How a simulated VLP-16 turns and when it fires: what the ray caster needs to know, and what the packets say.
struct Vlp16Stream {
  double rpm = 600;
  double first_azimuth_rad = 0;  ///< of the first firing; grows from +y to +x
  int64_t first_ns = 0;          ///< time of the first firing, from the hour
  uint8_t return_mode = lidar::kVelodyneStrongest;

  /// When laser `laser` (0 to 15) of firing sequence `firing` fires, after the first firing.
  double time_us(std::size_t firing, std::size_t laser) const;
  /// Where it points then, not wrapped.
  double azimuth_rad(std::size_t firing, std::size_t laser) const;
  /// Firing sequences of one turn, rounded down.
  std::size_t firings_per_turn() const;
};

/// What one laser saw in one firing.
struct Vlp16Return {
  double range_m = 0;  ///< 0: nothing; beyond 131 m likewise
  uint8_t reflectivity = 0;
  double second_range_m = 0;  ///< in dual return: of the last return, where it is another one than the strongest
  uint8_t second_reflectivity = 0;
};

inline constexpr std::size_t kVlp16Lasers = 16;
inline constexpr std::size_t kVlp16FiringsPerPacket = 24;  ///< 12 in dual return

using Vlp16Packet = std::array<std::byte, lidar::kVelodynePacketBytes>;

/// The packet that begins with firing sequence `first_firing`. Ranges are rounded to 2 mm, azimuths to 0.01 degree.
/// @param returns  of its firing sequences, 16 each, laser 0 first; missing ones at the end saw nothing.
Vlp16Packet make_vlp16_packet(const Vlp16Stream& stream, std::size_t first_firing,
                              std::span<const Vlp16Return> returns);

/// A recording of whole packets, arrival stamps as the firing times after `start_ns` (realtime).
/// @param returns  16 for each firing sequence from the first on.
/// @return bytes of a pcap file
std::vector<std::byte> make_vlp16_pcap(const Vlp16Stream& stream, std::span<const Vlp16Return> returns,
                                       int64_t start_ns);

}  // namespace roomcal::tools
