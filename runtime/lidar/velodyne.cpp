#include "runtime/lidar/velodyne.h"

#include <array>
#include <cmath>

#include "runtime/lidar/point_sink.h"

namespace roomcal::lidar {

namespace {

constexpr std::size_t kBlocks = 12, kChannels = 32, kBlockBytes = 100;
constexpr std::size_t kStampAt = 1200, kModeAt = 1204, kProductAt = 1205;
constexpr int64_t kHour_ns = 3'600'000'000'000;
// A step larger than this is a jump over the angles that the sensor was told to leave out, not a turn of its head: at
// 20 Hz a VLP-16 turns by 0.8 degrees from block to block.
constexpr int kMaxStepCdeg = 200;

/// How a model fires within a block. Times in us, from the manuals' timing tables.
struct Firing {
  std::size_t lasers;   ///< a firing sequence has
  std::size_t at_once;  ///< lasers that fire together
  double laser_us;      ///< from one group of lasers to the next
  double sequence_us;   ///< from one firing sequence to the next
  double range_unit_m;
};

constexpr Firing kVlp16Firing = {16, 1, 2.304, 55.296, 0.002};
constexpr Firing kVlp32cFiring = {32, 2, 2.304, 55.296, 0.004};
constexpr Firing kHdl32eFiring = {32, 1, 1.152, 46.080, 0.002};

constexpr const Firing& firing_of(Model model) {
  return model == Model::kVlp16 ? kVlp16Firing : model == Model::kVlp32c ? kVlp32cFiring : kHdl32eFiring;
}

constexpr double channel_us(const Firing& firing, std::size_t channel) {
  return firing.sequence_us * static_cast<double>(channel / firing.lasers) +
         firing.laser_us * static_cast<double>(channel % firing.lasers / firing.at_once);
}

constexpr double block_us(const Firing& firing) {
  return firing.sequence_us * static_cast<double>(kChannels / firing.lasers);
}

/// Per channel of a block: when it fires, and by which part of the block's turn the head has moved on until then.
struct ChannelTimes {
  std::array<double, kChannels> part{};
  std::array<int32_t, kChannels> offset_ns{};
};

constexpr ChannelTimes make_times(const Firing& firing) {
  ChannelTimes times;
  for (std::size_t i = 0; i < kChannels; ++i) {
    times.part[i] = channel_us(firing, i) / block_us(firing);
    times.offset_ns[i] = static_cast<int32_t>(channel_us(firing, i) * 1000 + 0.5);
  }
  return times;
}

constexpr ChannelTimes kVlp16Times = make_times(kVlp16Firing);
constexpr ChannelTimes kVlp32cTimes = make_times(kVlp32cFiring);
constexpr ChannelTimes kHdl32eTimes = make_times(kHdl32eFiring);

const ChannelTimes& times_of(Model model) {
  return model == Model::kVlp16 ? kVlp16Times : model == Model::kVlp32c ? kVlp32cTimes : kHdl32eTimes;
}

/// Early units write a full turn as 360.00 degrees instead of 0: seen in a capture of 2014.
uint16_t azimuth_of(Bytes bytes, std::size_t block) {
  const uint16_t azimuth = le16(bytes, block * kBlockBytes + 2);
  return azimuth == kTurnCdeg ? uint16_t{0} : azimuth;
}

Status check_blocks(Bytes bytes, bool dual) {
  std::array<uint16_t, kBlocks> azimuths{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    if (le16(bytes, i * kBlockBytes) != 0xEEFF) return {StatusCode::kCorrupt, "a block does not begin with FF EE"};
    const uint16_t azimuth = azimuth_of(bytes, i);
    if (azimuth >= kTurnCdeg) return {StatusCode::kCorrupt, "an azimuth is beyond 360 degrees"};
    if (!dual || i % 2 == 0) azimuths[count++] = azimuth;
    if (dual && i % 2 == 1 && azimuth != azimuths[count - 1])
      return {StatusCode::kCorrupt, "the two returns of a firing have different azimuths"};
  }
  if (!azimuths_plausible({azimuths.data(), count})) return {StatusCode::kCorrupt, "azimuths jump to and fro"};
  return ok_status();
}

/// Turn of the head during block `first` of a group (one block, or a dual-return pair): towards the next group.
/// The last group, and one before a jump, take the step of the nearest group that has one.
int step_cdeg(Bytes bytes, std::size_t first, std::size_t group) {
  for (std::size_t i = first; i + group < kBlocks; i += group) {
    const int step = forward_step_cdeg(azimuth_of(bytes, i), azimuth_of(bytes, i + group));
    if (step <= kMaxStepCdeg) return step;
  }
  for (std::size_t i = first; i >= group; i -= group) {
    const int step = forward_step_cdeg(azimuth_of(bytes, i - group), azimuth_of(bytes, i));
    if (step <= kMaxStepCdeg) return step;
  }
  return 0;
}

/// One group: its azimuth, its turn, and where its ranges stand.
struct Group {
  std::size_t block = 0;
  Direction azimuth;
  double step_rad = 0;
  int32_t base_ns = 0;
  bool dual = false;
};

class VelodyneDecoder {
 public:
  VelodyneDecoder(const Calibration& calibration, Bytes bytes, PointSink& sink)
      : calibration_(calibration),
        bytes_(bytes),
        sink_(sink),
        firing_(firing_of(calibration.model)),
        times_(times_of(calibration.model)) {}

  void decode(const Group& group) {
    for (std::size_t channel = 0; channel < kChannels; ++channel) {
      const std::size_t at = group.block * kBlockBytes + 4 + channel * 3;
      if (!group.dual) {
        add(group, channel, at, 0);
        continue;
      }
      const std::size_t strongest_at = at + kBlockBytes;
      const uint16_t last = le16(bytes_, at), strongest = le16(bytes_, strongest_at);
      if (strongest != 0) add(group, channel, strongest_at, 0);
      if (last != 0 && last != strongest) add(group, channel, at, strongest == 0 ? 0 : 1);
    }
  }

 private:
  void add(const Group& group, std::size_t channel, std::size_t at, uint8_t return_index) {
    const uint16_t raw = le16(bytes_, at);
    if (raw == 0) return;
    const std::size_t laser = channel % firing_.lasers;
    const Beam& beam = calibration_.beams[laser];
    const Calibration::Trig& trig = calibration_.trig[laser];
    const double range_m = raw * firing_.range_unit_m + beam.range_offset_m;
    if (!sink_.plausible(range_m)) return;
    const Direction azimuth = group.azimuth.turned_slightly(group.step_rad * times_.part[channel])
                                  .turned(beam.azimuth_offset_rad, trig.sin_offset, trig.cos_offset);
    SweepPoint& point = sink_.add();
    place_from_y(beam, trig, azimuth, range_m, point);
    point.range_m = static_cast<float>(range_m);
    point.azimuth_rad = wrapped(azimuth.angle_rad);
    point.offset_ns = group.base_ns + times_.offset_ns[channel];
    point.beam = static_cast<uint16_t>(laser);
    point.reflectivity = u8(bytes_, at + 2);
    point.return_index = return_index;
  }

  const Calibration& calibration_;
  Bytes bytes_;
  PointSink& sink_;
  const Firing& firing_;
  const ChannelTimes& times_;
};

}  // namespace

double velodyne_channel_us(Model model, std::size_t channel) { return channel_us(firing_of(model), channel); }
double velodyne_block_us(Model model) { return block_us(firing_of(model)); }

Status inspect_velodyne(const Calibration& calibration, Bytes bytes, PacketHeader& header) {
  if (bytes.size() != kVelodynePacketBytes) return {StatusCode::kUnsupported, "a Velodyne point packet has 1206 bytes"};
  header = {};
  header.return_mode = u8(bytes, kModeAt);
  header.product_byte = u8(bytes, kProductAt);
  if (header.return_mode < kVelodyneStrongest || header.return_mode > kVelodyneDual)
    return {StatusCode::kUnsupported, "the return mode is none of 37, 38, 39 (hex)"};
  const bool dual = header.return_mode == kVelodyneDual;
  ROOMCAL_TRY(check_blocks(bytes, dual));
  const uint32_t stamp_us = le32(bytes, kStampAt);
  if (stamp_us >= 3'600'000'000U) return {StatusCode::kCorrupt, "the time of the hour is beyond an hour"};
  header.stamp_ns = static_cast<int64_t>(stamp_us) * 1000;
  header.stamp_modulo_ns = kHour_ns;
  header.returns = dual ? 2 : 1;
  header.other_sensor = header.product_byte != info(calibration.model).product_byte;
  header.interval_ns =
      static_cast<int64_t>(block_us(firing_of(calibration.model)) * 1000 * (dual ? kBlocks / 2 : kBlocks));
  return ok_status();
}

void decode_velodyne(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                     std::span<SweepPoint> points, DecodedPacket& decoded) {
  PointSink sink(points, decoded, info(calibration.model));
  VelodyneDecoder decoder(calibration, bytes, sink);
  const std::size_t size = header.returns;
  const double group_ns = block_us(firing_of(calibration.model)) * 1000;
  for (std::size_t block = 0; block < kBlocks; block += size) {
    const uint16_t azimuth = azimuth_of(bytes, block);
    const auto offset_ns = static_cast<int32_t>(std::lround(group_ns * static_cast<double>(block / size)));
    decoder.decode({block, Direction::of(cdeg_to_rad(azimuth)), cdeg_to_rad(step_cdeg(bytes, block, size)),
                    base_ns + offset_ns, size == 2});
    sink.end_block(azimuth, offset_ns);
  }
}

}  // namespace roomcal::lidar
