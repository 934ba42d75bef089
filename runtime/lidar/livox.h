#pragma once

#include <span>

#include "runtime/lidar/packet.h"

namespace roomcal::lidar {

/// Livox Mid-360 point data, types 1 (mm) and 2 (cm): 36 bytes of head, then Cartesian points in the unit's own axes.
///
/// The four lines fire in turn; the rosette has no turns, so sweeps are cut by time. A wrong CRC-32 is reported, not
/// refused: no real capture was at hand to prove what the field covers. Written from the public protocol only, tried on
/// synthetic packets only.
/// Source: Livox-SDK2, livox_lidar_def.h; "Livox Mid-360 communication protocol", point cloud data.
inline constexpr std::size_t kLivoxHeadBytes = 36;

Status inspect_livox(const Calibration& calibration, Bytes bytes, PacketHeader& header);
void decode_livox(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                  std::span<SweepPoint> points, DecodedPacket& decoded);

/// CRC-32 (IEEE 802.3, reflected), as the packet's head carries it over stamp and points.
uint32_t crc32_ieee(Bytes bytes);

}  // namespace roomcal::lidar
