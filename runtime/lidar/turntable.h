#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/lidar/sweep.h"
#include "runtime/math/se3.h"

namespace roomcal::lidar {

/// Where the table stood at a moment. Not wrapped: a full turn later it is 2 pi more.
struct StampedAngle {
  Stamp stamp;
  double angle_rad = 0;
};

/// How a 2-D profiler sits on its turntable; from the factory, like the angles of a 3-D LiDAR's beams.
///
/// The lidar frame does not turn, and the axis goes through its origin:
///   p_lidar = R(axis_lidar, angle) * T_lidar_profiler * p_profiler
/// So the translation of T_lidar_profiler is the profiler's offset from the axis, and its rotation holds the tilt of
/// the profiler's plane against the axis and where angle zero is.
struct TurntableMounting {
  Vec3 axis_lidar = Vec3::UnitY();  ///< unit; angles grow right-handed about it
  SE3 T_lidar_profiler;             ///< at angle zero
};

struct TurntableOptions {
  TurntableMounting mounting;
  std::size_t capacity = 1'000'000;  ///< points of a sweep; when full, every second one goes and so on
  std::size_t waiting = 65'536;      ///< points that wait for the angle after them: those of 0.25 s at 250 kHz
  std::size_t angles = 1'024;        ///< that are remembered: 10 s at 100 Hz, for profiles that come late
  int64_t max_gap_ns = 25'000'000;   ///< between two angles: two of three SYNCs at 100 Hz
  double max_step_rad = 0.15;        ///< between two angles
  double sweep_rad = kPi;            ///< what makes a sweep whole: a profiler that sees all around needs half a turn
};

/// Since begin(), points in all: offered = kept + thinned + without_angle + crowded_out + not_finite + beyond +
/// waiting.
struct TurntableCounters {
  uint64_t offered = 0;
  uint64_t kept = 0;           ///< in the sweep now
  uint64_t thinned = 0;        ///< left out to make room
  uint64_t without_angle = 0;  ///< too far from the angles around them
  uint64_t crowded_out = 0;    ///< too many waited for an angle
  uint64_t not_finite = 0;     ///< or absurd
  uint64_t beyond = 0;         ///< after the sweep was whole
  uint32_t profiles = 0, angles = 0;
  uint32_t gaps = 0;         ///< pairs of angles too far apart
  uint32_t clock_jumps = 0;  ///< angles stamped before the one before
};

/// Puts the profiles of a turning 2-D LiDAR together to one sweep of the whole sphere.
///
/// A point's place follows from the table's angle at its own time, interpolated between the two stamped angles around
/// it; there is no extrapolation. Where they are too far apart, its points are dropped and the sweep is flagged
/// kSweepAngleGap. More points than there is room for are thinned evenly: every second one goes, later ones are taken
/// in the same measure; stride() tells.
class Turntable {
 public:
  Turntable() = default;

  /// Bytes that create() takes from its arena.
  static std::size_t arena_bytes(const TurntableOptions& options);
  /// @return kInvalidArgument for an axis that is no unit vector, a mounting that is not finite or no rotation, or
  ///         capacities and limits of zero; kOutOfMemory.
  static Result<Turntable> create(const TurntableOptions& options, Arena& arena);

  /// Forgets the sweep so far, and all angles. Call it when the table begins to turn: while it stands, all points fall
  /// into one plane.
  void begin();

  /// The next angle, in the order of time.
  /// @return kInvalidArgument, and nothing changes, for an angle that is not a number or a stamp of no clock or of
  ///         another clock than before. An angle stamped before the one before is a set clock: what waits is dropped
  ///         and the sweep flagged.
  Status add_angle(const StampedAngle& angle);

  /// One turn of the profiler, or a part of it.
  /// @param profile  in the profiler's frame; its flags become the sweep's, except kSweepPartial.
  /// @param stamp  of its first firing, in the angles' clock: the sensor's own is not that.
  /// @return kInvalidArgument, and nothing changes, for a stamp of no clock or of another clock than the angles'.
  /// Cost: about 60 ns a point, here or in the add_angle() that it waits for.
  Status add_profile(const Sweep& profile, const Stamp& stamp);

  /// The sweep is whole; what comes now is beyond it.
  bool whole() const;
  /// No more angles: what waits is dropped. The sweep is flagged kSweepPartial if it is not whole.
  ///
  /// Frame: lidar. `azimuth_rad` is the profiler's. `offset_ns` is 0: a sweep takes longer than it can hold, and the
  /// device stands still meanwhile. The view holds until begin().
  const Sweep& finish();

  const TurntableCounters& counters() const { return counters_; }
  /// One in so many points was kept.
  uint32_t stride() const { return stride_; }

 private:
  /// A point in the profiler's frame and when it was measured.
  struct Waiting {
    SweepPoint point;
    int64_t ns = 0;
  };

  bool clock_fits(const Stamp& stamp) const;
  void check_step(const StampedAngle& before, const StampedAngle& angle);
  bool close_enough(const StampedAngle& a, const StampedAngle& b) const;
  void place_waiting();
  void place(const Waiting& waiting);
  bool angle_at(int64_t ns, double& angle_rad);
  void keep(const SweepPoint& point, double angle_rad, int64_t ns);
  void thin();
  void drop_waiting();
  std::span<const StampedAngle> known() const { return angles_.first(angle_count_); }

  TurntableOptions options_;
  std::span<SweepPoint> points_;
  std::span<Waiting> waiting_;  ///< in the order of coming
  std::span<StampedAngle> angles_;
  std::size_t waiting_count_ = 0, angle_count_ = 0;
  std::size_t last_pair_ = 0;  ///< where the last angle was found
  ClockId clock_ = ClockId::kUnknown;
  uint32_t stride_ = 1;
  uint64_t accepted_ = 0;  ///< points with an angle
  bool placed_any_ = false;
  double first_rad_ = 0, reach_rad_ = 0;
  int64_t first_ns_ = 0, last_ns_ = 0;
  Sweep sweep_;
  TurntableCounters counters_;
};

}  // namespace roomcal::lidar
