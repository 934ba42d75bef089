#pragma once

#include <span>

#include "runtime/lidar/packet.h"

namespace roomcal::lidar {

/// RoboSense Helios-16P: 1248 bytes, big-endian, 42 of head, 12 blocks of {FF EE, azimuth, 32 x {range, reflectivity}}.
///
/// Two firings of 16 lasers a block; in dual return (calibration.dual_returns, as the DIFOP packet says) one firing and
/// both of its returns. Azimuths go in whole hundredths of a degree, as the vendor's driver does it. Axes: x forward
/// (azimuth 0), y left, azimuth grows clockwise; the lens stands 34.98 mm off the axis.
/// Source: RoboSense Helios-16P user guide; layout as facts also in rs_driver, decoder_RSHELIOS_16P.hpp.
inline constexpr std::size_t kRobosensePacketBytes = 1248;
inline constexpr uint32_t kMsopId = 0x55AA055A, kDifopId = 0xA5FF005A;

Status inspect_robosense(const Calibration& calibration, Bytes bytes, PacketHeader& header);
void decode_robosense(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                      std::span<SweepPoint> points, DecodedPacket& decoded);

/// Angles and return mode out of a DIFOP packet.
/// @return kUnsupported if it is none; kUnavailable if its table is empty (the unit was never calibrated);
/// kInvalidArgument
///         if the angles are absurd. `calibration` is then unchanged.
Status read_difop(Bytes bytes, Calibration& calibration);

}  // namespace roomcal::lidar
