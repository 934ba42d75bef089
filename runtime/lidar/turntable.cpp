#include "runtime/lidar/turntable.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace roomcal::lidar {

namespace {

constexpr int64_t kLargestStamp_ns = int64_t{1} << 61;  // sums and differences of such stamps do not overflow
constexpr double kLargestAngle_rad = 1e6;               // beyond, a double's steps are no longer small against a beam
constexpr float kLargestRange_m = 10'000;
constexpr double kUnitTolerance = 1e-6;

bool is_rotation(const Mat33& R) {
  return (R.transpose() * R - Mat33::Identity()).cwiseAbs().maxCoeff() < kUnitTolerance && R.determinant() > 0;
}

bool is_usable(const SweepPoint& p) {
  const auto within = [](float value) { return std::abs(value) <= kLargestRange_m; };  // NaN is not
  return within(p.x_m) && within(p.y_m) && within(p.z_m);
}

Vec3 position(const SweepPoint& p) {
  return {static_cast<double>(p.x_m), static_cast<double>(p.y_m), static_cast<double>(p.z_m)};
}

/// Rodrigues' formula.
Vec3 turned(const Vec3& v, const Vec3& axis, double angle_rad) {
  const double s = std::sin(angle_rad), c = std::cos(angle_rad);
  return v * c + axis.cross(v) * s + axis * (axis.dot(v) * (1 - c));
}

}  // namespace

std::size_t Turntable::arena_bytes(const TurntableOptions& options) {
  return options.capacity * sizeof(SweepPoint) + options.waiting * sizeof(Waiting) +
         options.angles * sizeof(StampedAngle) + alignof(SweepPoint) + alignof(Waiting) + alignof(StampedAngle);
}

Result<Turntable> Turntable::create(const TurntableOptions& options, Arena& arena) {
  const TurntableMounting& mounting = options.mounting;
  if (!(std::abs(mounting.axis_lidar.norm() - 1) < kUnitTolerance))
    return Status{StatusCode::kInvalidArgument, "a turntable's axis is a unit vector"};
  if (!mounting.T_lidar_profiler.t.allFinite() || !is_rotation(mounting.T_lidar_profiler.R))
    return Status{StatusCode::kInvalidArgument, "a profiler's mounting is a rotation and a finite offset"};
  if (options.capacity == 0 || options.waiting == 0 || options.angles < 2)
    return Status{StatusCode::kInvalidArgument, "a turntable needs room for points and for two angles"};
  if (options.max_gap_ns <= 0 || !(options.max_step_rad > 0) || !(options.sweep_rad > 0))
    return Status{StatusCode::kInvalidArgument, "a turntable's gap, step and sweep are above zero"};
  Turntable table;
  table.options_ = options;
  table.points_ = arena.allocate_uninitialized<SweepPoint>(options.capacity);
  table.waiting_ = arena.allocate_uninitialized<Waiting>(options.waiting);
  table.angles_ = arena.allocate_uninitialized<StampedAngle>(options.angles);
  if (table.points_.empty() || table.waiting_.empty() || table.angles_.empty()) return out_of_arena("turntable");
  return table;
}

void Turntable::begin() {
  waiting_count_ = angle_count_ = last_pair_ = 0;
  clock_ = ClockId::kUnknown;
  stride_ = 1;
  accepted_ = 0;
  placed_any_ = false;
  first_rad_ = reach_rad_ = 0;
  first_ns_ = last_ns_ = 0;
  sweep_ = {};
  counters_ = {};
}

bool Turntable::clock_fits(const Stamp& stamp) const {
  if (stamp.clock == ClockId::kUnknown || std::abs(stamp.ns) > kLargestStamp_ns) return false;
  return clock_ == ClockId::kUnknown || stamp.clock == clock_;
}

Status Turntable::add_angle(const StampedAngle& angle) {
  if (!(std::abs(angle.angle_rad) <= kLargestAngle_rad))
    return {StatusCode::kInvalidArgument, "a turntable's angle is a finite number"};
  if (!clock_fits(angle.stamp)) return {StatusCode::kInvalidArgument, "angles and profiles need stamps of one clock"};
  clock_ = angle.stamp.clock;
  ++counters_.angles;
  if (angle_count_ > 0) check_step(angles_[angle_count_ - 1], angle);
  if (angle_count_ == angles_.size()) {
    const std::size_t half = angle_count_ - angle_count_ / 2;
    std::copy(angles_.begin() + static_cast<std::ptrdiff_t>(half), angles_.end(), angles_.begin());
    angle_count_ -= half;
  }
  angles_[angle_count_++] = angle;
  place_waiting();
  return ok_status();
}

void Turntable::check_step(const StampedAngle& before, const StampedAngle& angle) {
  if (angle.stamp.ns > before.stamp.ns) {
    counters_.gaps += !close_enough(before, angle);
    return;
  }
  ++counters_.clock_jumps;
  sweep_.flags |= kSweepAngleGap;
  drop_waiting();
  angle_count_ = 0;
}

bool Turntable::close_enough(const StampedAngle& a, const StampedAngle& b) const {
  return b.stamp.ns - a.stamp.ns <= options_.max_gap_ns && std::abs(b.angle_rad - a.angle_rad) <= options_.max_step_rad;
}

Status Turntable::add_profile(const Sweep& profile, const Stamp& stamp) {
  if (!clock_fits(stamp)) return {StatusCode::kInvalidArgument, "angles and profiles need stamps of one clock"};
  clock_ = stamp.clock;
  ++counters_.profiles;
  sweep_.flags |= profile.flags & ~uint32_t{kSweepPartial};
  sweep_.packets += profile.packets;
  sweep_.lost_packets += profile.lost_packets;
  sweep_.beam_count = std::max(sweep_.beam_count, profile.beam_count);
  for (const SweepPoint& point : profile.points) {
    ++counters_.offered;
    if (!is_usable(point)) {
      ++counters_.not_finite;
    } else if (waiting_count_ == waiting_.size()) {
      ++counters_.crowded_out;
      sweep_.flags |= kSweepAngleGap;
    } else {
      waiting_[waiting_count_++] = {point, stamp.ns + point.offset_ns};
    }
  }
  place_waiting();
  return ok_status();
}

/// All whose time has an angle after it; the others keep waiting, in their order.
void Turntable::place_waiting() {
  const int64_t until_ns = angle_count_ == 0 ? -kLargestStamp_ns * 2 : angles_[angle_count_ - 1].stamp.ns;
  std::size_t left = 0;
  for (std::size_t i = 0; i < waiting_count_; ++i) {
    if (waiting_[i].ns < until_ns) {
      place(waiting_[i]);
    } else {
      waiting_[left++] = waiting_[i];
    }
  }
  waiting_count_ = left;
}

void Turntable::drop_waiting() {
  counters_.without_angle += waiting_count_;
  waiting_count_ = 0;
}

/// @return false where there is no pair of angles around it that is close enough.
bool Turntable::angle_at(int64_t ns, double& angle_rad) {
  const auto angles = known();
  const auto around = [&](std::size_t i) {
    return i + 1 < angles.size() && angles[i].stamp.ns <= ns && ns <= angles[i + 1].stamp.ns;
  };
  if (!around(last_pair_)) {
    const auto after = std::lower_bound(angles.begin(), angles.end(), ns,
                                        [](const StampedAngle& a, int64_t at_ns) { return a.stamp.ns < at_ns; });
    const auto next = static_cast<std::size_t>(after - angles.begin());
    last_pair_ = next == 0 ? 0 : next - 1;
    if (!around(last_pair_)) return false;
  }
  const StampedAngle &a = angles[last_pair_], &b = angles[last_pair_ + 1];
  if (!close_enough(a, b)) return false;
  const double share = static_cast<double>(ns - a.stamp.ns) / static_cast<double>(b.stamp.ns - a.stamp.ns);
  angle_rad = a.angle_rad + (b.angle_rad - a.angle_rad) * share;
  return true;
}

void Turntable::place(const Waiting& waiting) {
  double angle_rad = 0;
  if (!angle_at(waiting.ns, angle_rad)) {
    ++counters_.without_angle;
    // Before the first point nothing is missing: the profiler ran before the table did.
    if (placed_any_) sweep_.flags |= kSweepAngleGap;
    return;
  }
  if (!placed_any_) {
    placed_any_ = true;
    first_rad_ = angle_rad;
    first_ns_ = waiting.ns;
  }
  const double turned_rad = std::abs(angle_rad - first_rad_);
  if (turned_rad > options_.sweep_rad) {
    reach_rad_ = options_.sweep_rad;
    ++counters_.beyond;
    return;
  }
  reach_rad_ = std::max(reach_rad_, turned_rad);
  keep(waiting.point, angle_rad, waiting.ns);
}

void Turntable::keep(const SweepPoint& point, double angle_rad, int64_t ns) {
  const uint64_t number = accepted_++;
  if (number % stride_ == 0 && counters_.kept == points_.size()) thin();
  if (number % stride_ != 0) {
    ++counters_.thinned;
    return;
  }
  const TurntableMounting& mounting = options_.mounting;
  const Vec3 p_lidar = turned(mounting.T_lidar_profiler * position(point), mounting.axis_lidar, angle_rad);
  SweepPoint& kept = points_[counters_.kept++];
  kept = point;
  kept.x_m = static_cast<float>(p_lidar.x());
  kept.y_m = static_cast<float>(p_lidar.y());
  kept.z_m = static_cast<float>(p_lidar.z());
  kept.offset_ns = 0;
  first_ns_ = std::min(first_ns_, ns);
  last_ns_ = std::max(last_ns_, ns);
}

/// Point i of the sweep is the stride * i-th that had an angle; afterwards as well, at twice the stride.
void Turntable::thin() {
  const auto before = static_cast<std::size_t>(counters_.kept), after = (before + 1) / 2;
  for (std::size_t i = 0; i < after; ++i) points_[i] = points_[2 * i];
  counters_.kept = after;
  counters_.thinned += before - after;
  stride_ *= 2;
}

bool Turntable::whole() const { return placed_any_ && reach_rad_ >= options_.sweep_rad; }

const Sweep& Turntable::finish() {
  drop_waiting();
  if (!whole()) sweep_.flags |= kSweepPartial;
  sweep_.points = points_.first(static_cast<std::size_t>(counters_.kept));
  sweep_.stamp = {first_ns_, clock_};
  sweep_.duration_ns = placed_any_ ? last_ns_ - first_ns_ : 0;
  return sweep_;
}

}  // namespace roomcal::lidar
