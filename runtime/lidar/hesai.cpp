#include "runtime/lidar/hesai.h"

#include <array>

#include "runtime/lidar/hesai_timing.h"
#include "runtime/lidar/point_sink.h"
#include "runtime/lidar/utc.h"

namespace roomcal::lidar {

namespace {

/// Where a tail holds its fields, from the tail's start.
struct Tail {
  std::size_t mode, rpm, date, us, factory, bytes;
  int year_zero;
};
constexpr Tail kXtTail = {10, 11, 13, 19, 23, 24, 1900};
constexpr Tail kQt64Tail = {16, 10, 18, 12, 17, 24, 1900};
constexpr Tail kQt128Tail = {12, 13, 15, 21, 25, 26, 1900};
constexpr Tail kPandarTail = {14, 8, 16, 10, 15, 22, 2000};
constexpr std::size_t kQt128ModeFlagAt = 5;  // in the tail: which firing loop a dual-return packet is of

struct Layout {
  Model model;
  std::size_t head_bytes, blocks, channels, unit_bytes, block_head_bytes;
  const Tail* tail;

  constexpr std::size_t block_bytes() const { return block_head_bytes + channels * unit_bytes; }
  constexpr std::size_t body_end() const { return head_bytes + blocks * block_bytes(); }
};

constexpr std::array kLayouts = {
    Layout{Model::kXt16, 12, 8, 16, 4, 2, &kXtTail},        Layout{Model::kXt32, 12, 8, 32, 4, 2, &kXtTail},
    Layout{Model::kXt32m, 12, 6, 32, 4, 2, &kXtTail},       Layout{Model::kQt64, 12, 4, 64, 4, 2, &kQt64Tail},
    Layout{Model::kQt128, 12, 2, 128, 4, 2, &kQt128Tail},   Layout{Model::kPandar40p, 0, 10, 40, 3, 4, &kPandarTail},
    Layout{Model::kPandar64, 8, 6, 64, 3, 2, &kPandarTail},
};
constexpr std::size_t kBodyCrc = 4, kSafety = 17, kSequence = 4, kTailCrc = 4, kSignature = 32;

const Layout& layout_of(Model model) {
  for (const Layout& layout : kLayouts)
    if (layout.model == model) return layout;
  return kLayouts[0];
}

/// A QT128 may leave out its functional safety part; sizes tell, whatever the flags say.
bool has_safety(const Layout& layout, std::size_t size) {
  const std::size_t without = layout.body_end() + kBodyCrc + layout.tail->bytes;
  return size >= without + kSafety && size != without + kSequence + kTailCrc + kSignature;
}

std::size_t tail_start(const Layout& layout, std::size_t size) {
  if (layout.model != Model::kQt128) return layout.body_end();
  return layout.body_end() + kBodyCrc + (has_safety(layout, size) ? kSafety : 0);
}

bool size_fits(const Layout& layout, std::size_t size) {
  const std::size_t end = tail_start(layout, size) + layout.tail->bytes;
  return size == end || size == end + kSequence || size == end + kSequence + kTailCrc || size == end + kSignature ||
         size == end + kSequence + kSignature || size == end + kSequence + kTailCrc + kSignature;
}

bool head_fits(const Layout& layout, Bytes bytes) {
  if (layout.head_bytes == 0) return (be16(bytes, 0) == 0xFFEE || be16(bytes, 0) == 0xEEFF);
  if (be16(bytes, 0) != 0xEEFF) return false;
  const std::size_t lasers_at = layout.head_bytes == 12 ? 6 : 2;
  return u8(bytes, lasers_at) == layout.channels && u8(bytes, lasers_at + 1) == layout.blocks;
}

bool fits(const Layout& layout, Bytes bytes) { return size_fits(layout, bytes.size()) && head_fits(layout, bytes); }

/// Millimetres that one count of range means.
uint8_t range_unit_mm(const Layout& layout, Bytes bytes) {
  return layout.head_bytes == 12 ? u8(bytes, 9) : layout.head_bytes == 8 ? u8(bytes, 5) : uint8_t{4};
}

/// Points per firing, and which block of a group holds the strongest. 0 returns: not a return mode.
struct ReturnMode {
  uint8_t returns = 0;
  int8_t strongest = -1;  ///< -1: the mode does not say
};

constexpr ReturnMode return_mode(uint8_t mode) {
  switch (mode) {
    case 0x33:  // first
    case 0x34:  // second
    case 0x37:  // strongest
    case 0x38:  // last
      return {1, 0};
    case 0x39:  // last, strongest
    case 0x3C:  // first, strongest
      return {2, 1};
    case 0x3A:  // first, second
    case 0x3B:  // first and last
      return {2, -1};
    case 0x3E:  // strongest, second strongest
      return {2, 0};
    case 0x3D:  // first, last, strongest
      return {3, 2};
    default:
      return {};
  }
}

uint16_t azimuth_of(const Layout& layout, Bytes bytes, std::size_t block) {
  return le16(bytes, layout.head_bytes + block * layout.block_bytes() + layout.block_head_bytes - 2);
}

Status check_blocks(const Layout& layout, Bytes bytes, std::size_t returns) {
  std::array<uint16_t, 16> azimuths{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < layout.blocks; ++i) {
    const uint16_t azimuth = azimuth_of(layout, bytes, i);
    if (azimuth >= kTurnCdeg) return {StatusCode::kCorrupt, "an azimuth is beyond 359.99 degrees"};
    if (i % returns == 0) azimuths[count++] = azimuth;
    if (azimuth != azimuths[count - 1])
      return {StatusCode::kCorrupt, "the returns of a firing have different azimuths"};
    const std::size_t mark_at = layout.head_bytes + i * layout.block_bytes();
    if (layout.block_head_bytes == 4 && be16(bytes, mark_at) != be16(bytes, 0))
      return {StatusCode::kCorrupt, "a block does not begin with its mark"};
  }
  if (!azimuths_plausible({azimuths.data(), count})) return {StatusCode::kCorrupt, "azimuths jump to and fro"};
  return ok_status();
}

Status read_time(const Tail& tail, Bytes end, int64_t& stamp_ns) {
  const uint32_t us = le32(end, tail.us);
  // One second of overrun is seen where the second turns while the packet is put together.
  if (us >= 2'000'000) return {StatusCode::kCorrupt, "microseconds beyond a second"};
  const std::size_t date = tail.date;
  if (u8(end, date + 1) > 12 || u8(end, date + 2) > 31 || u8(end, date + 3) > 23 || u8(end, date + 4) > 59 ||
      u8(end, date + 5) > 60)
    return {StatusCode::kCorrupt, "no such date or time of day"};
  const int64_t seconds =
      utc_seconds(tail.year_zero + u8(end, tail.date), u8(end, tail.date + 1), u8(end, tail.date + 2),
                  u8(end, tail.date + 3), u8(end, tail.date + 4), u8(end, tail.date + 5));
  stamp_ns = seconds * 1'000'000'000 + static_cast<int64_t>(us) * 1000;
  return ok_status();
}

void read_sequence(const Layout& layout, Bytes bytes, PacketHeader& header) {
  const std::size_t at = tail_start(layout, bytes.size()) + layout.tail->bytes;
  header.has_sequence = at + kSequence <= bytes.size() && bytes.size() - at != kSignature;
  if (header.has_sequence) header.sequence = le32(bytes, at);
}

/// One firing of all lasers: its blocks and its time.
struct Group {
  std::size_t block = 0;
  Direction azimuth;
  int32_t base_ns = 0;
  bool second_loop = false;
};

class HesaiDecoder {
 public:
  HesaiDecoder(const Calibration& calibration, const PacketHeader& header, Bytes bytes, PointSink& sink)
      : calibration_(calibration),
        bytes_(bytes),
        sink_(sink),
        layout_(layout_of(calibration.model)),
        mode_(return_mode(header.return_mode)),
        range_unit_m_(0.001 * range_unit_mm(layout_, bytes)) {}

  void decode(const Group& group) {
    for (std::size_t channel = 0; channel < layout_.channels; ++channel) {
      if (mode_.returns == 1) {
        add(group, channel, unit_at(group.block, channel), 0);
      } else {
        add_returns(group, channel);
      }
    }
  }

 private:
  std::size_t unit_at(std::size_t block, std::size_t channel) const {
    return layout_.head_bytes + block * layout_.block_bytes() + layout_.block_head_bytes + channel * layout_.unit_bytes;
  }

  std::size_t strongest_block(const Group& group, std::size_t channel) const {
    if (mode_.strongest >= 0 && le16(bytes_, unit_at(group.block + static_cast<std::size_t>(mode_.strongest), channel)))
      return group.block + static_cast<std::size_t>(mode_.strongest);
    std::size_t best = group.block;
    for (std::size_t b = group.block + 1; b < group.block + mode_.returns; ++b) {
      const std::size_t at = unit_at(b, channel), best_at = unit_at(best, channel);
      if (le16(bytes_, at) != 0 && (le16(bytes_, best_at) == 0 || u8(bytes_, at + 2) > u8(bytes_, best_at + 2)))
        best = b;
    }
    return best;
  }

  void add_returns(const Group& group, std::size_t channel) {
    const std::size_t strongest = strongest_block(group, channel);
    std::array<uint16_t, 3> given{};
    uint8_t count = 0;
    const auto add_once = [&](std::size_t block) {
      const uint16_t range = le16(bytes_, unit_at(block, channel));
      for (uint8_t i = 0; i < count; ++i)
        if (given[i] == range) return;
      if (range == 0) return;
      add(group, channel, unit_at(block, channel), count);
      given[count++] = range;
    };
    add_once(strongest);
    for (std::size_t block = group.block; block < group.block + mode_.returns; ++block) add_once(block);
  }

  void add(const Group& group, std::size_t channel, std::size_t at, uint8_t return_index) {
    const uint16_t raw = le16(bytes_, at);
    if (raw == 0) return;
    const Beam& beam = calibration_.beams[channel];
    const Calibration::Trig& trig = calibration_.trig[channel];
    const double range_m = raw * range_unit_m_ + beam.range_offset_m;
    if (!sink_.plausible(range_m)) return;
    const Direction azimuth = group.azimuth.turned(beam.azimuth_offset_rad, trig.sin_offset, trig.cos_offset);
    SweepPoint& point = sink_.add();
    place_from_y(beam, trig, azimuth, range_m, point);
    point.range_m = static_cast<float>(range_m);
    point.azimuth_rad = wrapped(azimuth.angle_rad);
    point.offset_ns = group.base_ns + hesai_channel_ns(layout_.model, channel, group.second_loop);
    point.beam = static_cast<uint16_t>(channel);
    point.reflectivity = u8(bytes_, at + 2);
    point.return_index = return_index;
  }

  const Calibration& calibration_;
  Bytes bytes_;
  PointSink& sink_;
  const Layout& layout_;
  ReturnMode mode_;
  double range_unit_m_;
};

/// Time of the packet's first firing relative to the time in its tail.
int32_t first_firing_ns(const Layout& layout, std::size_t returns) {
  return hesai_block_ns(layout.model, 0, layout.blocks, returns) + hesai_first_channel_ns(layout.model);
}

}  // namespace

const ModelInfo* identify_hesai(Bytes bytes) {
  for (const Layout& layout : kLayouts)
    if (fits(layout, bytes)) return &info(layout.model);
  return nullptr;
}

Status inspect_hesai(const Calibration& calibration, Bytes bytes, PacketHeader& header) {
  const Layout& layout = layout_of(calibration.model);
  if (!size_fits(layout, bytes.size()))
    return {StatusCode::kUnsupported, "the size is not that of this model's point packets"};
  if (!head_fits(layout, bytes))
    return {StatusCode::kUnsupported, "the head is not this model's: mark, lasers or blocks differ"};
  header = {};
  const Tail& tail = *layout.tail;
  const Bytes end = bytes.subspan(tail_start(layout, bytes.size()));
  header.return_mode = u8(end, tail.mode);
  header.returns = return_mode(header.return_mode).returns;
  if (header.returns == 0 || layout.blocks % header.returns != 0)
    return {StatusCode::kUnsupported, "the return mode is none of this model's"};
  if (range_unit_mm(layout, bytes) == 0) return {StatusCode::kCorrupt, "the unit of range is 0 mm"};
  ROOMCAL_TRY(check_blocks(layout, bytes, header.returns));
  ROOMCAL_TRY(read_time(tail, end, header.stamp_ns));
  header.stamp_ns += first_firing_ns(layout, header.returns);
  header.motor_rpm = le16(end, tail.rpm);
  header.product_byte = u8(end, tail.factory);
  header.other_sensor = header.product_byte != 0x42 && header.product_byte != 0x43;
  header.interval_ns = hesai_interval_ns(layout.model, layout.blocks, header.returns);
  read_sequence(layout, bytes, header);
  return ok_status();
}

void decode_hesai(const Calibration& calibration, const PacketHeader& header, Bytes bytes, int32_t base_ns,
                  std::span<SweepPoint> points, DecodedPacket& decoded) {
  const Layout& layout = layout_of(calibration.model);
  PointSink sink(points, decoded, info(calibration.model));
  HesaiDecoder decoder(calibration, header, bytes, sink);
  const bool flag = (u8(bytes, tail_start(layout, bytes.size()) + kQt128ModeFlagAt) & 1) != 0;
  const int32_t first_ns = first_firing_ns(layout, header.returns);
  for (std::size_t block = 0; block < layout.blocks; block += header.returns) {
    const int32_t offset_ns = hesai_block_ns(layout.model, block, layout.blocks, header.returns) - first_ns;
    const uint16_t azimuth = azimuth_of(layout, bytes, block);
    const bool second_loop = header.returns == 1 ? block % 2 == 1 : !flag;
    decoder.decode({block, Direction::of(cdeg_to_rad(azimuth)), base_ns + offset_ns, second_loop});
    sink.end_block(azimuth, offset_ns + hesai_first_channel_ns(layout.model));
  }
}

}  // namespace roomcal::lidar
