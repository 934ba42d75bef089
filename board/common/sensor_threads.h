#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "board/common/packet_driver.h"
#include "board/common/pulse.h"
#include "drivers/os/page_faults.h"
#include "drivers/os/thread.h"
#include "runtime/base/latest.h"
#include "runtime/face/vitals.h"
#include "runtime/grab/clock_map.h"
#include "runtime/grab/image_ring.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::board {

/// What every thread of the runtime shares with the supervisor.
struct ThreadLink {
  Pulse pulse;
  std::atomic<bool> stop{false};
  std::atomic<bool> armed{false};                          ///< from here on page faults count
  std::atomic<uint64_t> minor_faults{0}, major_faults{0};  ///< of the thread since then

  /// By the thread, once a round.
  void beat(int64_t now_ns);

 private:
  bool marked_ = false;
  drivers::PageFaultMark mark_;
};

/// Counts events to a rate over the last two seconds or so.
class RateMeter {
 public:
  double update(uint64_t count, int64_t now_ns);

 private:
  static constexpr int64_t kWindow_ns = 2'000'000'000;
  uint64_t count_ = 0;
  int64_t since_ns_ = 0;
  double rate_hz_ = 0;
};

/// Takes one camera's images into its ring, all the time; the source mends itself within.
class CameraThread final : public drivers::Thread::Body {
 public:
  void prepare(const face::CameraVitals& facts, ports::ImageSource& source, grab::ImageRing& ring,
               const ports::SystemClocks& clocks);
  void run() override;

  /// Supervisor only.
  const face::CameraVitals& vitals() { return told_.get(); }
  ThreadLink link;

 private:
  void take(int64_t now_ns);
  void tell(int64_t now_ns);

  ports::ImageSource* source_ = nullptr;
  grab::ImageRing* ring_ = nullptr;
  const ports::SystemClocks* clocks_ = nullptr;
  grab::ClockMap clock_map_;
  face::CameraVitals vitals_;
  RateMeter rate_;
  Latest<face::CameraVitals> told_;
};

/// Receives the packets of all LiDARs into their trays.
class LidarThread final : public drivers::Thread::Body {
 public:
  explicit LidarThread() = default;

  void prepare(const ports::SystemClocks& clocks) { clocks_ = &clocks; }
  /// Before the thread starts.
  /// @param packets  where packets go. @param counters  of what they become.
  void add(const face::LidarVitals& facts, PacketDriver& driver, ports::PacketVisitor& packets,
           const lidar::SweepCounters& counters);
  void run() override;

  /// Supervisor only.
  const face::LidarVitals& vitals(std::size_t i) { return feeds_[i].told.get(); }
  std::size_t size() const { return count_; }
  ThreadLink link;

 private:
  struct Feed {
    PacketDriver* driver = nullptr;
    ports::PacketVisitor* packets = nullptr;
    const lidar::SweepCounters* counters = nullptr;
    face::LidarVitals vitals;
    RateMeter rate;
    Latest<face::LidarVitals> told;
  };
  void wait() const;
  void drain(Feed& feed, int64_t now_ns);

  std::array<Feed, calib::kMaxLidars> feeds_;
  std::size_t count_ = 0;
  const ports::SystemClocks* clocks_ = nullptr;
};

}  // namespace roomcal::board
