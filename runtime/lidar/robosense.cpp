#include "runtime/lidar/robosense.h"

#include <array>

#include "runtime/lidar/point_sink.h"

namespace roomcal::lidar {

namespace {

constexpr std::size_t kHead = 42, kBlocks = 12, kChannels = 32, kLasers = 16, kBlockBytes = 100;
constexpr std::size_t kSecondsAt = 20, kMicrosecondsAt = 26, kTypeAt = 30;
constexpr uint8_t kHeliosType = 6;
constexpr double kRangeUnit_m = 0.0025, kLensOffset_m = 0.03498, kFiring_us = 55.56;
constexpr int kMaxStepCdeg = 200;     // larger: a jump over angles that are switched off
constexpr int kUnknownStepCdeg = 20;  // ten turns a second: where a packet shows no step at all

// When a laser fires after its block's beginning; the second firing follows 55.56 us later.
constexpr std::array<double, kChannels> kLaser_us = {
    0.00,  3.15,  6.30,  9.45,  13.26, 17.08, 20.56, 23.71, 26.53, 27.77, 31.49, 32.73, 36.46, 38.94, 41.42, 43.91,
    55.56, 58.70, 61.85, 65.00, 68.82, 72.64, 76.12, 79.27, 82.08, 83.32, 87.05, 88.29, 92.01, 94.50, 96.98, 99.46};

constexpr std::size_t kReturnModeAt = 300, kPitchAt = 468, kYawAt = 564;  // in a DIFOP packet

uint16_t azimuth_of(Bytes bytes, std::size_t block) { return be16(bytes, kHead + block * kBlockBytes + 2); }
constexpr double block_us(bool dual) { return dual ? kFiring_us : 2 * kFiring_us; }

int step_cdeg(Bytes bytes, std::size_t block) {
  for (std::size_t i = block; i + 1 < kBlocks; ++i) {
    const int step = forward_step_cdeg(azimuth_of(bytes, i), azimuth_of(bytes, i + 1));
    if (step <= kMaxStepCdeg) return step;
  }
  for (std::size_t i = block; i > 0; --i) {
    const int step = forward_step_cdeg(azimuth_of(bytes, i - 1), azimuth_of(bytes, i));
    if (step <= kMaxStepCdeg) return step;
  }
  return kUnknownStepCdeg;
}

Status check_blocks(Bytes bytes) {
  std::array<uint16_t, kBlocks> azimuths{};
  for (std::size_t i = 0; i < kBlocks; ++i) {
    if (be16(bytes, kHead + i * kBlockBytes) != 0xFFEE)
      return {StatusCode::kCorrupt, "a block does not begin with FF EE"};
    azimuths[i] = azimuth_of(bytes, i);
    if (azimuths[i] >= kTurnCdeg) return {StatusCode::kCorrupt, "an azimuth is beyond 359.99 degrees"};
  }
  if (!azimuths_plausible(azimuths)) return {StatusCode::kCorrupt, "azimuths jump to and fro"};
  return ok_status();
}

/// Signed hundredths of a degree: a sign byte, then 16 bits.
double difop_angle_rad(Bytes bytes, std::size_t at) {
  return cdeg_to_rad((u8(bytes, at) == 0 ? 1.0 : -1.0) * be16(bytes, at + 1));
}

struct Block {
  std::size_t number = 0;
  int azimuth_cdeg = 0, step_cdeg = 0;
  int32_t base_ns = 0;
};

class HeliosDecoder {
 public:
  HeliosDecoder(const Calibration& calibration, Bytes bytes, PointSink& sink)
      : calibration_(calibration), bytes_(bytes), sink_(sink), dual_(calibration.dual_returns) {}

  void decode(const Block& block) {
    for (std::size_t channel = 0; channel < kChannels; ++channel) {
      const bool second = dual_ && channel >= kLasers;
      const uint16_t range = range_at(block, channel);
      const uint16_t other = second ? range_at(block, channel - kLasers) : uint16_t{0};
      if (range == 0 || (second && range == other)) continue;
      add(block, channel, second && other != 0 ? 1 : 0);
    }
  }

 private:
  static std::size_t unit_at(const Block& block, std::size_t channel) {
    return kHead + block.number * kBlockBytes + 4 + channel * 3;
  }
  uint16_t range_at(const Block& block, std::size_t channel) const { return be16(bytes_, unit_at(block, channel)); }

  void add(const Block& block, std::size_t channel, uint8_t return_index) {
    const std::size_t at = unit_at(block, channel), laser = channel % kLasers;
    const double time_us = kLaser_us[dual_ ? laser : channel];
    const Beam& beam = calibration_.beams[laser];
    const Calibration::Trig& trig = calibration_.trig[laser];
    const double range_m = be16(bytes_, at) * kRangeUnit_m + beam.range_offset_m;
    if (!sink_.plausible(range_m)) return;
    const int cdeg = block.azimuth_cdeg + static_cast<int>(block.step_cdeg * time_us / block_us(dual_));
    const Direction lens = Direction::of(cdeg_to_rad(cdeg));
    const Direction azimuth = lens.turned(beam.azimuth_offset_rad, trig.sin_offset, trig.cos_offset);
    const double flat = range_m * trig.cos_elevation;
    SweepPoint& point = sink_.add();
    point.x_m = static_cast<float>(flat * azimuth.cos + kLensOffset_m * lens.cos);
    point.y_m = static_cast<float>(-flat * azimuth.sin - kLensOffset_m * lens.sin);
    point.z_m = static_cast<float>(range_m * trig.sin_elevation);
    point.range_m = static_cast<float>(range_m);
    point.azimuth_rad = wrapped(azimuth.angle_rad);
    point.offset_ns = block.base_ns + static_cast<int32_t>(time_us * 1000);
    point.beam = static_cast<uint16_t>(laser);
    point.reflectivity = u8(bytes_, at + 2);
    point.return_index = return_index;
  }

  const Calibration& calibration_;
  Bytes bytes_;
  PointSink& sink_;
  bool dual_;
};

}  // namespace

Status inspect_robosense(const Calibration& calibration, Bytes bytes, PacketHeader& header) {
  if (bytes.size() != kRobosensePacketBytes) return {StatusCode::kUnsupported, "an MSOP packet has 1248 bytes"};
  if (be32(bytes, 0) != kMsopId) return {StatusCode::kUnsupported, "an MSOP packet begins with 55 AA 05 5A"};
  ROOMCAL_TRY(check_blocks(bytes));
  header = {};
  const uint64_t seconds = static_cast<uint64_t>(be16(bytes, kSecondsAt)) << 32 | be32(bytes, kSecondsAt + 2);
  const uint32_t us = be32(bytes, kMicrosecondsAt);
  if (seconds > 0xFFFFFFFFU || us >= 1'000'000) return {StatusCode::kCorrupt, "the time stamp is absurd"};
  header.stamp_ns = static_cast<int64_t>(seconds) * 1'000'000'000 + static_cast<int64_t>(us) * 1000;
  header.product_byte = u8(bytes, kTypeAt);
  header.other_sensor = header.product_byte != kHeliosType;
  header.returns = calibration.dual_returns ? 2 : 1;
  header.interval_ns = static_cast<int64_t>(kBlocks * block_us(calibration.dual_returns) * 1000);
  return ok_status();
}

void decode_robosense(const Calibration& calibration, const PacketHeader&, Bytes bytes, int32_t base_ns,
                      std::span<SweepPoint> points, DecodedPacket& decoded) {
  PointSink sink(points, decoded, info(calibration.model));
  HeliosDecoder decoder(calibration, bytes, sink);
  for (std::size_t i = 0; i < kBlocks; ++i) {
    const auto offset_ns = static_cast<int32_t>(block_us(calibration.dual_returns) * 1000 * static_cast<double>(i));
    decoder.decode({i, azimuth_of(bytes, i), step_cdeg(bytes, i), base_ns + offset_ns});
    sink.end_block(azimuth_of(bytes, i), offset_ns);
  }
}

Status read_difop(Bytes bytes, Calibration& calibration) {
  if (bytes.size() != kRobosensePacketBytes || be32(bytes, 0) != kDifopId)
    return {StatusCode::kUnsupported, "a DIFOP packet has 1248 bytes and begins with A5 FF 00 5A"};
  std::array<Beam, kLasers> beams;
  bool any = false;
  for (std::size_t i = 0; i < kLasers; ++i) {
    beams[i].elevation_rad = difop_angle_rad(bytes, kPitchAt + 3 * i);
    beams[i].azimuth_offset_rad = difop_angle_rad(bytes, kYawAt + 3 * i);
    const uint16_t raw = be16(bytes, kPitchAt + 3 * i + 1);
    any = any || (raw != 0 && raw != 0xFFFF);
  }
  if (!any) return {StatusCode::kUnavailable, "the DIFOP packet carries no angles: give the unit's angle file"};
  Result<Calibration> read = make_calibration(Model::kHelios16p, beams);
  if (!read.ok()) return read.status();
  read.value().dual_returns = u8(bytes, kReturnModeAt) == 0;
  calibration = read.value();
  return ok_status();
}

}  // namespace roomcal::lidar
