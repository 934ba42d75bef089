#include "runtime/lidar/sweep_builder.h"

#include <algorithm>

#include "runtime/lidar/point_sink.h"

namespace roomcal::lidar {

namespace {

constexpr int64_t kPause_ns = 25'000'000;        // half a turn at 20 Hz: azimuths alone no longer count turns
constexpr int64_t kMaxSweep_ns = 2'000'000'000;  // what SweepPoint::offset_ns can hold, nearly
constexpr uint32_t kPaceSamples = 8;             // fewer packets say nothing about the pace
constexpr int kMaxStepCdeg = 200;                // a larger step is a gap, not the head's pace

}  // namespace

std::size_t SweepBuilder::arena_bytes(const SweepOptions& options) {
  return (options.capacity + kMaxPacketPoints) * sizeof(SweepPoint) + alignof(SweepPoint);
}

Result<SweepBuilder> SweepBuilder::create(const Calibration& calibration, const SweepOptions& options, Arena& arena) {
  if (options.capacity == 0) return Status{StatusCode::kInvalidArgument, "a sweep needs room for points"};
  if (options.cut_cdeg >= kTurnCdeg || options.cut_cdeg < kCutAtFirstAzimuth)
    return Status{StatusCode::kInvalidArgument, "the cut must be an azimuth of 0 to 359.99 degrees"};
  if (options.period_ns <= 0 || options.period_ns > kMaxSweep_ns)
    return Status{StatusCode::kInvalidArgument, "the period of a sweep must be above 0 and at most 2 s"};
  SweepBuilder builder;
  builder.calibration_ = &calibration;
  builder.options_ = options;
  builder.cut_cdeg_ = options.cut_cdeg;
  builder.points_ = arena.allocate_uninitialized<SweepPoint>(options.capacity + kMaxPacketPoints);
  if (builder.points_.empty()) return out_of_arena("sweep buffer");
  return builder;
}

void SweepBuilder::release() {
  if (!ready_) return;
  std::copy(points_.begin() + static_cast<std::ptrdiff_t>(done_points_),
            points_.begin() + static_cast<std::ptrdiff_t>(used_), points_.begin());
  used_ -= done_points_;
  done_points_ = 0;
  done_ = {};
  ready_ = false;
}

Status SweepBuilder::push(Bytes packet) {
  release();
  PacketHeader header;
  if (const Status status = inspect_packet(*calibration_, packet, header); !status.ok()) {
    const bool empty = status.code() == StatusCode::kUnavailable;
    ++(empty ? counters_.empty : status.code() == StatusCode::kCorrupt ? counters_.corrupt : counters_.unsupported);
    if (!empty) (open_.any ? open_.flags : pending_flags_) |= kSweepBadPackets;
    return status;
  }
  const PacketPlace place = tracker_.place(header, packet);
  if (place.order == PacketOrder::kDuplicate) {
    ++counters_.duplicates;
    (open_.any ? open_.flags : pending_flags_) |= kSweepDuplicates;
    return ok_status();
  }
  header_ = header;
  ++counters_.packets;
  if (place.order == PacketOrder::kLate) return add_late(packet, place);
  return add(packet, place);
}

void SweepBuilder::note_header() {
  if (header_.other_sensor) {
    ++counters_.other_sensor;
    open_.flags |= kSweepOtherSensor;
  }
  if (header_.checksum_wrong) {
    ++counters_.checksum_wrong;
    open_.flags |= kSweepBadPackets;
  }
  ++open_.packets;
}

bool SweepBuilder::interrupted_before(const PacketPlace& place) const {
  if (place.order != PacketOrder::kNext) return true;
  if (place.stamp_ns - open_.stamp_ns > kMaxSweep_ns) return true;
  return header_.turn_mark == TurnMark::kAzimuth && place.after_ns >= kPause_ns;
}

/// For families whose packets lie within one turn.
bool SweepBuilder::passes_cut_before(const PacketPlace& place) const {
  if (header_.turn_mark == TurnMark::kNumber) return header_.turn != open_.turn;
  if (header_.turn_mark == TurnMark::kTime) return place.stamp_ns - open_.stamp_ns >= options_.period_ns;
  return false;
}

void SweepBuilder::count_place(const PacketPlace& place) {
  if (place.order == PacketOrder::kRestart) ++counters_.restarts;
  counters_.lost += place.lost;
  open_.lost += place.lost;
  if (header_.interval_ns == 0 || place.order != PacketOrder::kNext) return;
  ++open_.pace_checked;
  open_.in_pace += place.in_pace;
  counters_.out_of_pace += !place.in_pace;
}

Status SweepBuilder::add(Bytes packet, const PacketPlace& place) {
  const bool was_open = open_.any;
  if (open_.any) {
    count_place(place);
    if (passes_cut_before(place)) {
      close(true);
    } else if (interrupted_before(place)) {
      close(false);
    }
  }
  const int64_t base_ns = open_.any ? place.stamp_ns - open_.stamp_ns : 0;
  DecodedPacket decoded;
  ROOMCAL_TRY(
      decode_packet(*calibration_, header_, packet, static_cast<int32_t>(base_ns), points_.subspan(used_), decoded));
  counters_.absurd_ranges += decoded.absurd_ranges;
  if (!open_.any) {
    open(place.stamp_ns, decoded.blocks.empty() ? 0 : decoded.blocks[0].azimuth_cdeg);
    // What was lost just before belongs to this sweep too: its beginning may be missing.
    if (was_open && place.lost > 0 && place.order == PacketOrder::kNext) open_.lost += place.lost;
  }
  if (header_.turn_mark == TurnMark::kAzimuth) {
    check_jump(decoded, place);
    append_by_azimuth(decoded, place.stamp_ns);
  } else {
    append(0, decoded.point_count);
    open_.units += header_.packet_units;
  }
  note_header();
  open_.last_ns = place.stamp_ns;
  return ok_status();
}

Status SweepBuilder::add_late(Bytes packet, const PacketPlace& place) {
  const bool of_turn = header_.turn_mark != TurnMark::kNumber || header_.turn == open_.turn;
  if (!open_.any || place.stamp_ns < open_.stamp_ns || !of_turn) {
    ++counters_.late_dropped;
    (open_.any ? open_.flags : pending_flags_) |= kSweepOutOfOrder;
    return ok_status();
  }
  DecodedPacket decoded;
  const auto base_ns = static_cast<int32_t>(place.stamp_ns - open_.stamp_ns);
  ROOMCAL_TRY(decode_packet(*calibration_, header_, packet, base_ns, points_.subspan(used_), decoded));
  ++counters_.late_used;
  counters_.absurd_ranges += decoded.absurd_ranges;
  open_.flags |= kSweepOutOfOrder;
  if (open_.lost > 0) {
    --open_.lost;  // it was taken for lost when its follower came
    --counters_.lost;
  }
  append(0, decoded.point_count);
  open_.units += header_.packet_units;
  note_header();
  return ok_status();
}

/// Points [begin, end) behind used_ join the open sweep, as far as there is room.
void SweepBuilder::append(std::size_t begin, std::size_t end) {
  const std::size_t room = options_.capacity - std::min(options_.capacity, open_points());
  const std::size_t kept = std::min(end - begin, room);
  if (begin > 0) {
    const auto from = points_.begin() + static_cast<std::ptrdiff_t>(used_ + begin);
    std::copy(from, from + static_cast<std::ptrdiff_t>(kept), points_.begin() + static_cast<std::ptrdiff_t>(used_));
  }
  if (kept < end - begin) open_.flags |= kSweepFull;
  counters_.dropped_points += end - begin - kept;
  counters_.points += kept;
  used_ += kept;
}

/// A sensor that leaves out angles pauses meanwhile. Azimuths that jump without a pause have a flipped bit.
void SweepBuilder::check_jump(const DecodedPacket& decoded, const PacketPlace& place) {
  const bool no_pause = place.order == PacketOrder::kNext && header_.interval_ns > 0 && place.in_pace;
  bool jump = jumped_within_;
  jumped_within_ = false;
  int last_cdeg = last_azimuth_cdeg_;
  for (std::size_t i = 0; i < decoded.blocks.size(); ++i) {
    const bool wide = forward_step_cdeg(last_cdeg, decoded.blocks[i].azimuth_cdeg) > kMaxStepCdeg;
    last_cdeg = decoded.blocks[i].azimuth_cdeg;
    (i == 0 ? jump : jumped_within_) |= wide;
  }
  if (!jump || !no_pause) return;
  ++counters_.azimuth_jumps;
  open_.flags |= kSweepBadPackets;
}

void SweepBuilder::append_by_azimuth(const DecodedPacket& decoded, int64_t stamp_ns) {
  for (std::size_t i = 0; i < decoded.blocks.size(); ++i) {
    const BlockMark& block = decoded.blocks[i];
    const int step = forward_step_cdeg(last_azimuth_cdeg_, block.azimuth_cdeg);
    last_azimuth_cdeg_ = block.azimuth_cdeg;
    if (step <= kMaxStepCdeg && step > 0) step_cdeg_ = step;
    open_.progress_cdeg += step;
    if (open_.progress_cdeg < kTurnCdeg) continue;
    const std::size_t cut = i == 0 ? 0 : decoded.blocks[i - 1].end;
    const int64_t cut_ns = stamp_ns + block.offset_ns;
    const int64_t shift_ns = cut_ns - open_.stamp_ns;
    const std::size_t rest = used_ + cut;  // where the next sweep's points lie
    const std::size_t end = used_ + decoded.point_count;
    append(0, cut);
    if (cut > 0) ++open_.packets;
    close(true);
    open(cut_ns, block.azimuth_cdeg);
    for (std::size_t p = rest; p < end; ++p) points_[p].offset_ns -= static_cast<int32_t>(shift_ns);
    append(rest - used_, end - used_);
    last_azimuth_cdeg_ = decoded.blocks.back().azimuth_cdeg;
    open_.progress_cdeg += forward_step_cdeg(block.azimuth_cdeg, last_azimuth_cdeg_);
    return;
  }
  append(0, decoded.point_count);
}

void SweepBuilder::open(int64_t stamp_ns, int azimuth_cdeg) {
  open_ = {};
  open_.any = true;
  open_.stamp_ns = open_.last_ns = stamp_ns;
  open_.flags = pending_flags_;
  pending_flags_ = 0;
  open_.turn = header_.turn;
  open_.turn_units = header_.turn_units;
  if (cut_cdeg_ == kCutAtFirstAzimuth) cut_cdeg_ = azimuth_cdeg;
  open_.progress_cdeg = forward_step_cdeg(cut_cdeg_, azimuth_cdeg);
  last_azimuth_cdeg_ = azimuth_cdeg;
  if (header_.turn_mark != TurnMark::kAzimuth) return;
  const int slack = 2 * std::max(step_cdeg_, 1);
  if (open_.progress_cdeg > std::max(slack, 100)) open_.flags |= kSweepPartial;
}

bool SweepBuilder::whole(bool at_cut) const {
  if (header_.turn_mark == TurnMark::kNumber) return open_.units >= open_.turn_units;
  if (at_cut) return true;
  if (header_.turn_mark == TurnMark::kTime) return open_.last_ns - open_.stamp_ns >= options_.period_ns * 95 / 100;
  return open_.progress_cdeg >= kTurnCdeg - 2 * std::max(step_cdeg_, 1);
}

uint32_t SweepBuilder::flags_at_close(bool at_cut) const {
  uint32_t flags = open_.flags;
  if (open_.lost > 0) flags |= kSweepLostPackets;
  if (!whole(at_cut)) {
    // A turn by number that has followers and a predecessor misses something in its middle.
    const bool middle = header_.turn_mark == TurnMark::kNumber && at_cut && !first_sweep_;
    flags |= middle ? kSweepLostPackets : kSweepPartial;
  }
  if (open_.pace_checked >= kPaceSamples && open_.in_pace * 2 < open_.pace_checked) flags |= kSweepWrongTiming;
  return flags;
}

void SweepBuilder::close(bool at_cut) {
  if (ready_) {  // a pause and a cut in one packet: the few points between them make no sweep
    counters_.dropped_points += open_points();
    used_ = done_points_;
    open_ = {};
    return;
  }
  done_.points = points_.first(used_);
  done_.stamp = {open_.stamp_ns, ClockId::kDevice};
  int32_t last_ns = 0;
  for (std::size_t i = used_ - std::min<std::size_t>(used_, kMaxPacketPoints); i < used_; ++i)
    last_ns = std::max(last_ns, points_[i].offset_ns);
  done_.duration_ns = last_ns;
  done_.beam_count = calibration_->beam_count;
  done_.flags = flags_at_close(at_cut);
  done_.packets = open_.packets;
  done_.lost_packets = open_.lost;
  done_points_ = used_;
  ready_ = true;
  ++counters_.sweeps;
  first_sweep_ = false;
  open_ = {};
}

void SweepBuilder::finish() {
  release();
  if (open_.any) close(false);
}

}  // namespace roomcal::lidar
