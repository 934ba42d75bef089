#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/arena.h"
#include "runtime/base/status.h"
#include "runtime/grab/sweep_source.h"
#include "runtime/lidar/sweep.h"
#include "runtime/lidar/sweep_builder.h"
#include "runtime/ports/packet_source.h"

namespace roomcal::grab {

inline constexpr std::size_t kMaxTraySweeps = 32;

/// One LiDAR between the thread that receives its packets and the one that wants whole sweeps: packets go in all the
/// time, sweeps are kept only while they are asked for. A sweep with a flag (a lost packet, a torn turn) is discarded
/// and counted; only dropped duplicates are forgiven.
///
/// One thread calls take() (through a packet source), one other the rest.
class SweepTray final : public SweepSource, public ports::PacketVisitor {
 public:
  SweepTray() = default;
  SweepTray(const SweepTray&) = delete;
  SweepTray& operator=(const SweepTray&) = delete;

  static std::size_t bytes(const lidar::SweepOptions& options, std::size_t sweeps);
  /// @param calibration  outlives the tray. @param sweeps  room for, at most kMaxTraySweeps.
  /// @return kInvalidArgument, kOutOfMemory.
  Status create(const lidar::Calibration& calibration, const lidar::SweepOptions& options, std::size_t sweeps,
                Arena& arena);

  /// Receiving thread: a packet of this LiDAR.
  void take(const ports::Packet& packet) override;

  void ask(std::size_t count) override;
  bool full() const override { return state_.load(std::memory_order_acquire) == State::kFull; }
  bool stop() override;
  std::span<const lidar::Sweep> sweeps() const override { return {sweeps_.data(), kept_}; }
  uint32_t discarded() const override { return discarded_.load(std::memory_order_relaxed); }
  uint32_t discarded_flags() const override { return discarded_flags_.load(std::memory_order_relaxed); }

  /// Receiving thread only; others get a copy of it.
  const lidar::SweepCounters& counters() const { return builder_.counters(); }

 private:
  enum class State : uint8_t { kIdle, kAsked, kKeeping, kFull };

  void consider(const lidar::Sweep& sweep);
  void keep(const lidar::Sweep& sweep);

  lidar::SweepBuilder builder_;
  std::array<std::span<lidar::SweepPoint>, kMaxTraySweeps> points_;
  std::array<lidar::Sweep, kMaxTraySweeps> sweeps_;
  std::size_t room_ = 0;
  std::size_t wanted_ = 0;
  std::size_t kept_ = 0;
  // Both sequentially consistent: either stop() sees a packet at work, or the packet sees that keeping has ended.
  std::atomic<State> state_{State::kIdle};
  std::atomic<bool> at_work_{false};
  std::atomic<uint32_t> discarded_{0}, discarded_flags_{0};
  bool skip_open_ = false;  ///< the sweep that was open when they were asked for began before
};

}  // namespace roomcal::grab
