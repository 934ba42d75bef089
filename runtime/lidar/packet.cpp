#include "runtime/lidar/packet.h"

#include <algorithm>
#include <array>

#include "runtime/lidar/hesai.h"
#include "runtime/lidar/livox.h"
#include "runtime/lidar/ouster.h"
#include "runtime/lidar/point_sink.h"
#include "runtime/lidar/r2000.h"
#include "runtime/lidar/robosense.h"
#include "runtime/lidar/velodyne.h"

namespace roomcal::lidar {

namespace {

constexpr std::size_t kPositionBytes = 512, kOusterImuBytes = 48;

const ModelInfo* identify_velodyne(Bytes bytes) {
  if (bytes.size() != kVelodynePacketBytes || le16(bytes, 0) != 0xEEFF) return nullptr;
  for (const ModelInfo& model : known_models())
    if (model.family == Family::kVelodyne && model.product_byte == u8(bytes, kVelodynePacketBytes - 1)) return &model;
  return nullptr;
}

bool ouster_imu(Bytes bytes) { return bytes.size() == kOusterImuBytes; }
bool livox_imu(Bytes bytes) { return bytes.size() == kLivoxHeadBytes + 24 && u8(bytes, 10) == 0; }
bool difop(Bytes bytes) { return bytes.size() == kRobosensePacketBytes && be32(bytes, 0) == kDifopId; }

}  // namespace

const char* to_string(PacketKind kind) {
  constexpr std::array kNames = {"points", "position", "difop", "imu", "other"};
  return kNames[static_cast<std::size_t>(kind)];
}

bool azimuths_plausible(std::span<const uint16_t> azimuth_cdeg) {
  constexpr int kUnevenCdeg = 60;  // beyond what a motor's jitter explains within a packet
  int turned = 0, uneven = 0;
  int usual = kTurnCdeg;
  for (std::size_t i = 1; i < azimuth_cdeg.size(); ++i)
    usual = std::min(usual, forward_step_cdeg(azimuth_cdeg[i - 1], azimuth_cdeg[i]));
  for (std::size_t i = 1; i < azimuth_cdeg.size(); ++i) {
    const int step = forward_step_cdeg(azimuth_cdeg[i - 1], azimuth_cdeg[i]);
    turned += step;
    uneven += step - usual > kUnevenCdeg;
  }
  return turned < kTurnCdeg && uneven <= 1;
}

PacketKind classify_packet(Model model, Bytes bytes) {
  const Family family = info(model).family;
  switch (family) {
    case Family::kVelodyne:
    case Family::kHesai:
      return bytes.size() == kPositionBytes  ? PacketKind::kPosition
             : bytes.size() > kPositionBytes ? PacketKind::kPoints
                                             : PacketKind::kOther;
    case Family::kOuster:
      return ouster_imu(bytes) ? PacketKind::kImu : bytes.size() > 1024 ? PacketKind::kPoints : PacketKind::kOther;
    case Family::kRobosense:
      return difop(bytes) ? PacketKind::kDifop : bytes.size() >= 1024 ? PacketKind::kPoints : PacketKind::kOther;
    case Family::kLivox:
      return livox_imu(bytes)                 ? PacketKind::kImu
             : bytes.size() > kLivoxHeadBytes ? PacketKind::kPoints
                                              : PacketKind::kOther;
    case Family::kPepperlFuchs:
      return bytes.size() >= kR2000HeadBytes && le16(bytes, 0) == 0xA25C ? PacketKind::kPoints : PacketKind::kOther;
  }
  return PacketKind::kOther;
}

const ModelInfo* identify_packet(Bytes bytes) {
  if (bytes.size() < kR2000HeadBytes) return nullptr;
  if (const ModelInfo* model = identify_velodyne(bytes)) return model;
  if (const ModelInfo* model = identify_hesai(bytes)) return model;
  if (bytes.size() == kRobosensePacketBytes && (be32(bytes, 0) == kMsopId || be32(bytes, 0) == kDifopId))
    return &info(Model::kHelios16p);
  PacketHeader header;
  const Calibration none;
  if (inspect_r2000(none, bytes, header).ok()) return &info(Model::kR2000);
  if (inspect_livox(none, bytes, header).ok() && le16(bytes, 5) > 0) return &info(Model::kMid360);
  return nullptr;
}

Status inspect_packet(const Calibration& calibration, Bytes bytes, PacketHeader& header) {
  switch (info(calibration.model).family) {
    case Family::kVelodyne:
      return inspect_velodyne(calibration, bytes, header);
    case Family::kHesai:
      return inspect_hesai(calibration, bytes, header);
    case Family::kOuster:
      return inspect_ouster(calibration, bytes, header);
    case Family::kRobosense:
      return inspect_robosense(calibration, bytes, header);
    case Family::kLivox:
      return inspect_livox(calibration, bytes, header);
    case Family::kPepperlFuchs:
      return inspect_r2000(calibration, bytes, header);
  }
  return {StatusCode::kInvalidArgument, "no such family"};
}

Status decode_packet(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                     std::span<SweepPoint> points, DecodedPacket& decoded) {
  decoded.point_count = 0;
  decoded.absurd_ranges = 0;
  decoded.blocks.clear();
  if (points.size() < kMaxPacketPoints) return {StatusCode::kCapacity, "room for one packet's points is needed"};
  switch (info(calibration.model).family) {
    case Family::kVelodyne:
      decode_velodyne(calibration, header, bytes, base_ns, points, decoded);
      break;
    case Family::kHesai:
      decode_hesai(calibration, header, bytes, base_ns, points, decoded);
      break;
    case Family::kOuster:
      decode_ouster(calibration, header, bytes, base_ns, points, decoded);
      break;
    case Family::kRobosense:
      decode_robosense(calibration, header, bytes, base_ns, points, decoded);
      break;
    case Family::kLivox:
      decode_livox(calibration, header, bytes, base_ns, points, decoded);
      break;
    case Family::kPepperlFuchs:
      decode_r2000(calibration, header, bytes, base_ns, points, decoded);
      break;
  }
  return ok_status();
}

}  // namespace roomcal::lidar
