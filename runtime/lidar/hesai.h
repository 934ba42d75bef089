#pragma once

#include <span>

#include "runtime/lidar/packet.h"

namespace roomcal::lidar {

/// Hesai PandarXT-16/32, XT32M, PandarQT64, QT128, Pandar40P, Pandar64: a head that names lasers, blocks and unit of
/// range (none on the 40P), blocks of {azimuth, lasers x {range u16, reflectivity u8[, confidence]}}, a tail with
/// return mode, speed, UTC, microseconds and, by a flag, a sequence number.
///
/// Azimuth of a point = block's azimuth + the beam's offset from the unit's file, as the vendor's reference does it. In
/// dual (triple) return the blocks of one firing follow each other with one azimuth; equal ranges are one point.
/// Sources: Hesai user manuals, "Point cloud data packet"; layouts as facts also in tier4/nebula, pandar_*.hpp.
Status inspect_hesai(const Calibration& calibration, Bytes bytes, PacketHeader& header);
void decode_hesai(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                  std::span<SweepPoint> points, DecodedPacket& decoded);

/// The model whose layout fits these bytes by size and head. @return nullptr if none.
const ModelInfo* identify_hesai(Bytes bytes);

}  // namespace roomcal::lidar
