#include "runtime/grab/turntable_tray.h"

#include <algorithm>

namespace roomcal::grab {

namespace {

/// How long the firings of one packet took; 0 where the packet does not say how fast the profiler turns.
int64_t firing_time_ns(const lidar::PacketHeader& header) {
  if (header.motor_rpm == 0 || header.turn_units == 0) return 0;
  const double turn_ns = 60e9 / header.motor_rpm;
  return static_cast<int64_t>(turn_ns * header.packet_units / header.turn_units);
}

}  // namespace

std::size_t TurntableTray::bytes(const lidar::SweepOptions& profile, const lidar::TurntableOptions& table) {
  return lidar::SweepBuilder::arena_bytes(profile) + lidar::Turntable::arena_bytes(table);
}

Status TurntableTray::create(const lidar::Calibration& calibration, const lidar::SweepOptions& profile,
                             const lidar::TurntableOptions& table, const ports::SystemClocks& clocks, Arena& arena) {
  Result<lidar::SweepBuilder> builder = lidar::SweepBuilder::create(calibration, profile, arena);
  ROOMCAL_TRY(builder.status());
  Result<lidar::Turntable> made = lidar::Turntable::create(table, arena);
  ROOMCAL_TRY(made.status());
  builder_ = builder.value();
  table_ = made.value();
  clocks_ = &clocks;
  return ok_status();
}

void TurntableTray::follow_clock(const ports::Packet& packet) {
  const lidar::PacketHeader& header = builder_.last_header();
  const int64_t now_ns = clocks_->now_ns();
  const int64_t arrived_ns = arrival_clock_.to_monotonic(packet.arrived, 0, now_ns, *clocks_).exposed_ns;
  const int64_t sent_ns = header.stamp_ns + firing_time_ns(header);
  const ImageTime at = sensor_clock_.to_monotonic({sent_ns, ClockId::kDevice}, 0, arrived_ns, *clocks_);
  sensor_ahead_ns_ = sent_ns - at.exposed_ns;
  clock_known_ = true;
}

void TurntableTray::take_angles() {
  std::size_t read = angles_read_.load(std::memory_order_relaxed);
  const std::size_t written = angles_written_.load(std::memory_order_acquire);
  for (; read != written; ++read) {
    const Angle& angle = angles_[read % kAngles];
    // An angle that does not fit shows in the sweep's flags.
    if (state_ == State::kKeeping)
      static_cast<void>(table_.add_angle({{angle.stamp_ns, ClockId::kMonotonic}, angle.rad}));
  }
  angles_read_.store(read, std::memory_order_release);
}

void TurntableTray::take(const ports::Packet& packet) {
  at_work_ = true;
  State begin = State::kBegin;
  if (state_.compare_exchange_strong(begin, State::kKeeping)) table_.begin();
  take_angles();
  if (builder_.push(packet.payload).ok()) follow_clock(packet);
  if (builder_.ready() && clock_known_ && state_ == State::kKeeping) take_profile();
  at_work_ = false;
}

void TurntableTray::take_profile() {
  const lidar::Sweep& profile = builder_.sweep();
  const Stamp stamp{profile.stamp.ns - sensor_ahead_ns_, ClockId::kMonotonic};
  static_cast<void>(table_.add_profile(profile, stamp));
  if (table_.whole()) finish();
}

void TurntableTray::finish() {
  const lidar::Sweep& sweep = table_.finish();
  State keeping = State::kKeeping;
  if ((sweep.flags & ~static_cast<uint32_t>(lidar::kSweepDuplicates)) == 0) {
    sweep_ = sweep;
    sweep_count_ = 1;
    state_.compare_exchange_strong(keeping, State::kFull);
    return;
  }
  ++discarded_;
  discarded_flags_ |= sweep.flags;
  table_.begin();  // the table turns on: another try
}

bool TurntableTray::wants_turn() const {
  const State state = state_;
  return state == State::kAsked || state == State::kBegin || state == State::kKeeping;
}

void TurntableTray::begin_turn() {
  State asked = State::kAsked;
  state_.compare_exchange_strong(asked, State::kBegin);
}

void TurntableTray::add_angle(int64_t stamp_ns, double angle_rad) {
  const std::size_t written = angles_written_.load(std::memory_order_relaxed);
  if (written - angles_read_.load(std::memory_order_acquire) == kAngles) return;
  angles_[written % kAngles] = {stamp_ns, angle_rad};
  angles_written_.store(written + 1, std::memory_order_release);
}

void TurntableTray::ask(std::size_t /*count*/) {
  sweep_count_ = 0;
  discarded_ = discarded_flags_ = 0;
  state_ = State::kAsked;
}

bool TurntableTray::stop() {
  State state = state_;
  while (state != State::kIdle && state != State::kFull)
    if (state_.compare_exchange_weak(state, State::kIdle)) break;
  return !at_work_;
}

}  // namespace roomcal::grab
