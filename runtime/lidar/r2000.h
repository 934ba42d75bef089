#pragma once

#include <span>

#include "runtime/lidar/packet.h"

namespace roomcal::lidar {

/// Pepperl+Fuchs R2000 (OMD...-R2000) scan data, packet types A (range), B (range, amplitude), C (both in 32 bits): the
/// profiler of a terrestrial scanner. Flat: z = 0, azimuth grows from +x to +y.
///
/// Chosen among the 2-D scanners because its protocol is public, complete and binary, over UDP as over TCP (pass each
/// TCP packet here by its packet_size). Written from the public protocol only, tried on synthetic packets only. Source:
/// "R2000 Ethernet communication protocol" (PFSDP), chapter "Scan data output".
inline constexpr std::size_t kR2000HeadBytes = 60;

Status inspect_r2000(const Calibration& calibration, Bytes bytes, PacketHeader& header);
void decode_r2000(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                  std::span<SweepPoint> points, DecodedPacket& decoded);

}  // namespace roomcal::lidar
