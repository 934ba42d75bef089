#pragma once

#include <span>

#include "runtime/lidar/packet.h"

namespace roomcal::lidar {

/// Velodyne VLP-16, VLP-32C and HDL-32E: 1206 bytes, 12 blocks of {FF EE, azimuth, 32 x {range u16, reflectivity u8}},
/// time of the hour in us, return mode, product.
///
/// Dual return: blocks 2k (last) and 2k+1 (strongest) are of the same firings and have the same azimuth; lasers turn on
/// towards the azimuth of the next PAIR. Where both hold the same range there was one return, and one point is given.
/// Sources: manuals 63-9243 (VLP-16; sections 6 and 9), 63-9325 (VLP-32C), 63-9113 (HDL-32E).
inline constexpr std::size_t kVelodynePacketBytes = 1206;
inline constexpr uint8_t kVelodyneStrongest = 0x37, kVelodyneLast = 0x38, kVelodyneDual = 0x39;

/// Time of laser `channel` (0 to 31 of a block) after its block's first firing. @pre a Velodyne model.
double velodyne_channel_us(Model model, std::size_t channel);
/// Time from one block's firings to the next one's.
double velodyne_block_us(Model model);

/// As inspect_packet() and decode_packet().
Status inspect_velodyne(const Calibration& calibration, Bytes bytes, PacketHeader& header);
void decode_velodyne(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                     std::span<SweepPoint> points, DecodedPacket& decoded);

}  // namespace roomcal::lidar
