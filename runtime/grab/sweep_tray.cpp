#include "runtime/grab/sweep_tray.h"

#include <algorithm>

namespace roomcal::grab {

std::size_t SweepTray::bytes(const lidar::SweepOptions& options, std::size_t sweeps) {
  return lidar::SweepBuilder::arena_bytes(options) +
         sweeps * (options.capacity * sizeof(lidar::SweepPoint) + alignof(lidar::SweepPoint));
}

Status SweepTray::create(const lidar::Calibration& calibration, const lidar::SweepOptions& options, std::size_t sweeps,
                         Arena& arena) {
  if (sweeps < 1 || sweeps > kMaxTraySweeps)
    return {StatusCode::kInvalidArgument, "a LiDAR keeps one to 32 sweeps of a shot"};
  Result<lidar::SweepBuilder> builder = lidar::SweepBuilder::create(calibration, options, arena);
  ROOMCAL_TRY(builder.status());
  builder_ = builder.value();
  for (std::size_t i = 0; i < sweeps; ++i) {
    points_[i] = arena.allocate_uninitialized<lidar::SweepPoint>(options.capacity);
    if (points_[i].empty()) return out_of_arena("sweeps of a LiDAR");
  }
  room_ = sweeps;
  return ok_status();
}

void SweepTray::take(const ports::Packet& packet) {
  at_work_ = true;
  State asked = State::kAsked;
  if (state_.compare_exchange_strong(asked, State::kKeeping)) skip_open_ = true;
  // What was refused is in the builder's counters and flags the sweep.
  static_cast<void>(builder_.push(packet.payload));
  if (builder_.ready() && state_ == State::kKeeping) consider(builder_.sweep());
  at_work_ = false;
}

void SweepTray::consider(const lidar::Sweep& sweep) {
  if (skip_open_) {
    skip_open_ = false;
    return;
  }
  if ((sweep.flags & ~static_cast<uint32_t>(lidar::kSweepDuplicates)) != 0) {
    discarded_flags_.fetch_or(sweep.flags, std::memory_order_relaxed);
    discarded_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  keep(sweep);
}

void SweepTray::keep(const lidar::Sweep& sweep) {
  std::copy(sweep.points.begin(), sweep.points.end(), points_[kept_].begin());
  sweeps_[kept_] = sweep;
  sweeps_[kept_].points = points_[kept_].first(sweep.points.size());
  ++kept_;
  State keeping = State::kKeeping;
  if (kept_ == wanted_) state_.compare_exchange_strong(keeping, State::kFull);
}

void SweepTray::ask(std::size_t count) {
  kept_ = 0;
  wanted_ = std::min(count, room_);
  discarded_ = 0;
  discarded_flags_ = 0;
  state_ = State::kAsked;
}

bool SweepTray::stop() {
  State state = state_;
  while (state == State::kAsked || state == State::kKeeping)
    if (state_.compare_exchange_weak(state, State::kIdle)) break;
  return !at_work_;
}

}  // namespace roomcal::grab
