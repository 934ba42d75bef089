#include "board/common/sensor_threads.h"

#include "drivers/os/wait.h"

namespace roomcal::board {

namespace {

constexpr int64_t kImageWait_ns = 100'000'000;  // a thread answers at least that often
constexpr int64_t kPacketWait_ns = 50'000'000;
constexpr int64_t kReplayTick_ns = 2'000'000;  // a replay has nothing to wait on

}  // namespace

void ThreadLink::beat(int64_t now_ns) {
  pulse.beat(now_ns);
  if (!armed.load(std::memory_order_acquire)) return;
  if (!marked_) {
    mark_ = drivers::PageFaultMark();
    marked_ = true;
  }
  const drivers::PageFaults faults = mark_.since();
  minor_faults.store(faults.minor, std::memory_order_relaxed);
  major_faults.store(faults.major, std::memory_order_relaxed);
}

double RateMeter::update(uint64_t count, int64_t now_ns) {
  if (since_ns_ == 0 || count < count_) {
    count_ = count;
    since_ns_ = now_ns;
  } else if (now_ns - since_ns_ >= kWindow_ns) {
    rate_hz_ = static_cast<double>(count - count_) / (static_cast<double>(now_ns - since_ns_) * 1e-9);
    count_ = count;
    since_ns_ = now_ns;
  }
  return rate_hz_;
}

void CameraThread::prepare(const face::CameraVitals& facts, ports::ImageSource& source, grab::ImageRing& ring,
                           const ports::SystemClocks& clocks) {
  vitals_ = facts;
  source_ = &source;
  ring_ = &ring;
  clocks_ = &clocks;
  tell(clocks.now_ns());
}

void CameraThread::run() {
  while (!link.stop.load(std::memory_order_acquire)) {
    const int64_t now_ns = clocks_->now_ns();
    link.beat(now_ns);
    take(now_ns);
    tell(clocks_->now_ns());
  }
}

void CameraThread::take(int64_t now_ns) {
  const MutableImageView place = ring_->begin_write();
  if (place.empty()) {  // the session is looking at all the others for this moment
    clocks_->sleep_until(now_ns + kReplayTick_ns);
    return;
  }
  ports::ImageFacts facts;
  if (!source_->next(kImageWait_ns, place, facts).ok()) return ring_->abandon();
  const grab::ImageTime time = clock_map_.to_monotonic(facts.exposed, facts.uncertainty_ns, facts.arrived_ns, *clocks_);
  ring_->publish(facts, time);
  vitals_.last_image_ns = facts.arrived_ns;
  vitals_.clock = facts.exposed.clock;
  vitals_.uncertainty_ns = time.uncertainty_ns;
  vitals_.clock_steps = clock_map_.steps();
}

void CameraThread::tell(int64_t now_ns) {
  vitals_.health = source_->health();
  vitals_.rate_hz = rate_.update(vitals_.health.images, now_ns);
  told_.set(vitals_);
}

void LidarThread::add(const face::LidarVitals& facts, PacketDriver& driver, ports::PacketVisitor& packets,
                      const lidar::SweepCounters& counters) {
  Feed& feed = feeds_[count_++];
  feed.driver = &driver;
  feed.packets = &packets;
  feed.counters = &counters;
  feed.vitals = facts;
  feed.told.set(facts);
}

void LidarThread::wait() const {
  std::array<int, calib::kMaxLidars> fds{};
  bool replays = false;
  for (std::size_t i = 0; i < count_; ++i) {
    fds[i] = feeds_[i].driver->fd();
    replays = replays || feeds_[i].driver->replays();
  }
  const int64_t deadline_ns = clocks_->now_ns() + (replays ? kReplayTick_ns : kPacketWait_ns);
  static_cast<void>(drivers::wait_readable(std::span<const int>(fds).first(count_), deadline_ns));
}

void LidarThread::run() {
  while (!link.stop.load(std::memory_order_acquire)) {
    wait();
    const int64_t now_ns = clocks_->now_ns();
    link.beat(now_ns);
    for (std::size_t i = 0; i < count_; ++i) drain(feeds_[i], now_ns);
  }
}

void LidarThread::drain(Feed& feed, int64_t now_ns) {
  const std::size_t taken = feed.driver->source().drain(*feed.packets);
  if (taken > 0) feed.vitals.last_packet_ns = now_ns;
  feed.vitals.connected = feed.driver->replays() || feed.driver->fd() >= 0;
  feed.vitals.packets = feed.driver->source().counters();
  feed.vitals.sweeps = *feed.counters;
  feed.vitals.sweep_rate_hz = feed.rate.update(feed.vitals.sweeps.sweeps, now_ns);
  feed.told.set(feed.vitals);
}

}  // namespace roomcal::board
