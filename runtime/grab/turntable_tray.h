#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/grab/clock_map.h"
#include "runtime/grab/sweep_source.h"
#include "runtime/lidar/sweep_builder.h"
#include "runtime/lidar/turntable.h"
#include "runtime/ports/packet_source.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::grab {

/// A 2-D profiler on a turntable as one LiDAR: packets become profiles, profiles and the table's angles one sweep.
///
/// Three threads meet here: one receives packets (take()), one drives the table (wants_turn(), begin_turn(),
/// add_angle()), and the session asks. Nobody waits.
///
///     ask() -> wants_turn() -> table at speed: begin_turn() -> profiles -> whole -> full()
///
/// Angles and profiles meet on the monotonic clock. The profiler's own clock is brought there by its quickest packets:
/// a packet goes out with its last firing, so what remains is what the network takes, some 0.2 ms, which at half a
/// radian a second is 0.1 mrad of the table, the same for the whole sweep.
class TurntableTray final : public SweepSource, public ports::PacketVisitor {
 public:
  TurntableTray() = default;
  TurntableTray(const TurntableTray&) = delete;
  TurntableTray& operator=(const TurntableTray&) = delete;

  static std::size_t bytes(const lidar::SweepOptions& profile, const lidar::TurntableOptions& table);
  /// @param calibration  of the profiler; outlives the tray. @return as SweepBuilder and Turntable, kOutOfMemory.
  Status create(const lidar::Calibration& calibration, const lidar::SweepOptions& profile,
                const lidar::TurntableOptions& table, const ports::SystemClocks& clocks, Arena& arena);

  /// Receiving thread: a packet of the profiler.
  void take(const ports::Packet& packet) override;
  const lidar::SweepCounters& counters() const { return builder_.counters(); }

  /// Table's thread: somebody waits for a sweep, so it is to turn.
  bool wants_turn() const;
  /// Table's thread: it turns at its speed; what is measured from now on counts.
  void begin_turn();
  /// Table's thread: where it stood, monotonic, in the order of time. Angles that find the queue full are lost, and the
  /// sweep then has a gap.
  void add_angle(int64_t stamp_ns, double angle_rad);

  /// One sweep, whatever `count` says: a table turns once for a shot.
  void ask(std::size_t count) override;
  bool full() const override { return state_.load(std::memory_order_acquire) == State::kFull; }
  bool stop() override;
  std::span<const lidar::Sweep> sweeps() const override { return {&sweep_, sweep_count_}; }
  uint32_t discarded() const override { return discarded_; }
  uint32_t discarded_flags() const override { return discarded_flags_; }

 private:
  enum class State : uint8_t { kIdle, kAsked, kBegin, kKeeping, kFull };
  struct Angle {
    int64_t stamp_ns = 0;
    double rad = 0;
  };
  static constexpr std::size_t kAngles = 256;

  void take_angles();
  void follow_clock(const ports::Packet& packet);
  void take_profile();
  void finish();

  lidar::SweepBuilder builder_;
  lidar::Turntable table_;
  const ports::SystemClocks* clocks_ = nullptr;
  ClockMap arrival_clock_, sensor_clock_;
  int64_t sensor_ahead_ns_ = 0;  ///< of the sensor's clock over the monotonic one
  bool clock_known_ = false;
  std::array<Angle, kAngles> angles_{};
  std::atomic<std::size_t> angles_written_{0}, angles_read_{0};
  std::atomic<State> state_{State::kIdle};
  std::atomic<bool> at_work_{false};
  lidar::Sweep sweep_;
  std::size_t sweep_count_ = 0;
  uint32_t discarded_ = 0, discarded_flags_ = 0;
};

}  // namespace roomcal::grab
