#include "drivers/relay/relay_worker.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "runtime/base/text_writer.h"

namespace roomcal::drivers {

using ports::ImageFault;

namespace {

constexpr int64_t kLookAfterNs = 1'000'000'000;
constexpr int64_t kPauseNs = 1'000'000;
// Whoever computes must not keep buffers from going back to the library. Without the right to it the thread is an
// ordinary one.
constexpr int kPriority = 5;

}  // namespace

// The library is inside a call as long as this lives.
class RelayWorker::Call {
 public:
  explicit Call(RelayWorker& worker) : worker_(worker) { worker.in_call_since_ns_ = worker.now_ns(); }
  ~Call() { worker_.in_call_since_ns_ = 0; }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

 private:
  RelayWorker& worker_;
};

RelayWorker::RelayWorker(std::string_view name, const RelayOptions& options, std::unique_ptr<LibraryCamera> camera,
                         const ports::SystemClocks& clocks, ports::Log& log)
    : clocks_(clocks),
      log_(log),
      camera_(std::move(camera)),
      hang_ns_(options.hang_ns),
      recovery_(options.recovery),
      health_(name, log) {}

void RelayWorker::wait_until(Lock& lock, std::condition_variable& condition, int64_t deadline_ns) const {
  condition.wait_for(lock, std::chrono::nanoseconds(std::max<int64_t>(deadline_ns - now_ns(), 0)));
}

void RelayWorker::prepare() {
  const Lock lock(mutex_);
  recovery_.start(now_ns());
  health_.start();
  woken_ = ending_ = ended_ = opened_once_ = offered_ = reading_ = false;
  returned_.clear();
  fire_ = FireState::kNone;
  hang_told_ = false;
}

Status RelayWorker::launch() {
  prepare();
  ThreadOptions options;
  options.name = health_.who();
  options.stack_bytes = 1024 * 1024;  // the library's own calls: XML, XPath
  options.fifo_priority = kPriority;
  return thread_.start(options, *this);
}

Status RelayWorker::first_open(int64_t deadline_ns) {
  Lock lock(mutex_);
  while (!opened_once_ && now_ns() < deadline_ns) wait_until(lock, for_reader_, deadline_ns);
  if (opened_once_) return first_open_;
  return {StatusCode::kUnavailable, "the camera's library does not answer; check bus and network, restart the program"};
}

bool RelayWorker::end(int64_t deadline_ns) {
  {
    Lock lock(mutex_);
    ending_ = woken_ = true;
    for_worker_.notify_one();
    while (!ended_ && now_ns() < deadline_ns) wait_until(lock, for_reader_, deadline_ns);
    if (!ended_) return false;
  }
  thread_.join();
  return true;
}

bool RelayWorker::take(int64_t deadline_ns, Offer& offer) {
  Lock lock(mutex_);
  expect_images(true);
  while (!offered_ && now_ns() < deadline_ns) wait_until(lock, for_reader_, deadline_ns);
  expect_images(false);
  if (!offered_) return false;
  offer = offer_;
  offered_ = false;
  reading_ = true;
  return true;
}

void RelayWorker::release(const Offer& offer, bool handed_over) {
  const Lock lock(mutex_);
  reading_ = false;
  if (handed_over) health_.image(offer.facts.lost_before, now_ns());
  if (!returned_.push_back(offer.image.slot)) health_.fault(ImageFault::kUnknownBuffer, now_ns());
  woken_ = true;
  for_worker_.notify_one();
}

ports::ImageHealth RelayWorker::health() {
  const Lock lock(mutex_);
  ports::ImageHealth health = health_.health();
  const int64_t since_ns = in_call_since_ns_;
  if (since_ns == 0 || now_ns() - since_ns < hang_ns_) return health;
  health.state = ports::SourceState::kFaulted;
  if (hang_told_.exchange(true)) return health;
  std::array<char, 120> line;
  TextWriter out(line);
  out.text(camera_->library()).text(" does not return; restart the program, update the library");
  log_.note(health_.who(), out.view());
  return health;
}

bool RelayWorker::streams() {
  const Lock lock(mutex_);
  return recovery_.order(now_ns()).step == RecoveryStep::kWatch;
}

bool RelayWorker::want_fire() {
  const Lock lock(mutex_);
  if (recovery_.order(now_ns()).step != RecoveryStep::kWatch) return false;
  fire_ = FireState::kWanted;
  woken_ = true;
  for_worker_.notify_one();
  return true;
}

bool RelayWorker::fired(int64_t deadline_ns) {
  Lock lock(mutex_);
  while (fire_ == FireState::kWanted && now_ns() < deadline_ns) wait_until(lock, for_reader_, deadline_ns);
  return std::exchange(fire_, FireState::kNone) == FireState::kDone;
}

// A camera that waits for a trigger cannot stall, except between a software trigger and its image.
void RelayWorker::expect_images(bool expected) {
  if (!camera_->free_running()) return;
  if (expected) recovery_.resume(now_ns());
  if (!expected) recovery_.pause(now_ns());
}

void RelayWorker::wake() {
  const Lock lock(mutex_);
  woken_ = true;
  for_worker_.notify_one();
}

void RelayWorker::run() {
  for (;;) {
    RecoveryOrder order;
    {
      const Lock lock(mutex_);
      if (ending_) break;
      order = recovery_.order(now_ns());
      health_.state(recovery_.state());
    }
    step(order);
  }
  close();
  const Lock lock(mutex_);
  recovery_.stop();
  health_.state(ports::SourceState::kClosed);
  ended_ = true;
  for_reader_.notify_all();
}

void RelayWorker::step(const RecoveryOrder& order) {
  switch (order.step) {
    case RecoveryStep::kWatch:
      return watch(order.until_ns);
    case RecoveryStep::kRestartStream:
      return restart();
    case RecoveryStep::kReopen:
      return reopen();
    case RecoveryStep::kResetPort: {
      const Lock lock(mutex_);
      return recovery_.port_reset(now_ns());
    }
    case RecoveryStep::kGiveUp:
    case RecoveryStep::kStayClosed:
      break;
  }
  close();
  Lock lock(mutex_);
  health_.step(order.step);
  if (!ending_) wait_until(lock, for_worker_, std::min(order.until_ns, now_ns() + kLookAfterNs));
}

void RelayWorker::begun(const LibraryResult& result) {
  stamps_.restart();
  numbers_.restart();
  if (!result.ok()) return fault(result.fault);
  const Lock lock(mutex_);
  recovery_.begun(now_ns());
}

void RelayWorker::reopen() {
  close();
  LibraryResult result;
  {
    const Call call(*this);
    result = camera_->open(*this);
  }
  open_ = result.ok();
  begun(result);
  const Lock lock(mutex_);
  health_.state(recovery_.state());
  if (opened_once_ && (result.ok() || !is_absence(result.fault))) health_.step(RecoveryStep::kReopen);
  if (opened_once_) return;
  opened_once_ = true;
  first_open_ = result.status;
  for_reader_.notify_all();
}

void RelayWorker::restart() {
  withdraw();
  LibraryResult result;
  {
    const Call call(*this);
    result = camera_->restart();
  }
  begun(result);
  const Lock lock(mutex_);
  health_.step(RecoveryStep::kRestartStream);
}

void RelayWorker::close() {
  if (!std::exchange(open_, false)) return;
  withdraw();
  const Call call(*this);
  camera_->close();
}

// Gets every buffer back from the reader's side; a reader that copies is done in a moment.
void RelayWorker::withdraw() {
  {
    Lock lock(mutex_);
    for_worker_.wait(lock, [&] { return !reading_; });
    if (std::exchange(offered_, false) && !returned_.push_back(offer_.image.slot))
      health_.fault(ImageFault::kUnknownBuffer, now_ns());
  }
  give_back_returned();
}

void RelayWorker::give_back_returned() {
  FixedVector<int, kMaxLibraryBuffers> slots;
  {
    const Lock lock(mutex_);
    slots = std::exchange(returned_, {});
  }
  for (const int slot : slots) camera_->give_back(slot);
}

void RelayWorker::watch(int64_t until_ns) {
  // A camera that runs away must not take the processor from everybody with this thread's priority.
  clocks_.sleep_until(drained_ns_ + kPauseNs);
  drained_ns_ = now_ns();
  give_back_returned();
  fire_if_wanted();
  drain();
  look_after();
  Lock lock(mutex_);
  if (recovery_.stalled(now_ns())) {
    lock.unlock();
    ImageFault cause = ImageFault::kStall;
    {
      const Call call(*this);
      cause = camera_->diagnose();
    }
    return fault(cause);
  }
  if (recovery_.order(now_ns()).step != RecoveryStep::kWatch) return;
  const int64_t latest_ns = looked_after_ns_ + kLookAfterNs;
  if (!woken_) wait_until(lock, for_worker_, std::min(std::max(until_ns, now_ns() + kLookAfterNs / 10), latest_ns));
  woken_ = false;
}

void RelayWorker::look_after() {
  if (now_ns() - looked_after_ns_ < kLookAfterNs) return;
  looked_after_ns_ = now_ns();
  ImageFault found = ImageFault::kCount;
  {
    const Call call(*this);
    found = camera_->look_after(looked_after_ns_);
  }
  if (found != ImageFault::kCount) fault(found);
}

void RelayWorker::fire_if_wanted() {
  {
    const Lock lock(mutex_);
    if (fire_ != FireState::kWanted) return;
  }
  bool done = false;
  {
    const Call call(*this);
    done = camera_->fire();
  }
  const Lock lock(mutex_);
  fire_ = done ? FireState::kDone : FireState::kFailed;
  if (done) recovery_.resume(now_ns());
  for_reader_.notify_all();
}

void RelayWorker::drain() {
  LibraryImage image;
  while (camera_->poll(image)) {
    const std::size_t needed =
        luma_bytes(image.raw.format, image.raw.width_px, image.raw.height_px, image.raw.stride_bytes);
    if (image.fault == ImageFault::kCount && (needed == 0 || image.raw.bytes.size() < needed))
      image.fault = ImageFault::kShort;
    if (image.fault == ImageFault::kCount)
      take_whole(image);
    else
      take_damaged(image);
  }
}

void RelayWorker::take_damaged(const LibraryImage& image) {
  camera_->give_back(image.slot);
  fault(image.fault);
}

void RelayWorker::take_whole(const LibraryImage& image) {
  const SequenceCount::Step count = numbers_.next(image.number);
  Offer fresh{image,
              {image.exposed, image.uncertainty_ns, image.arrived_ns, count.sequence, count.lost_before,
               count.first_after_gap}};
  // The host has no clock of the camera's to compare with.
  const ClockId clock = image.exposed.clock;
  const ImageFault doubt = stamps_.judge(image.exposed, clock == ClockId::kDevice ? Stamp{} : clocks_.read(clock));
  if (doubt != ImageFault::kCount) {
    fault(doubt);
    fresh.facts.uncertainty_ns = image.latency_ns / 2;
    fresh.facts.exposed = {image.arrived_ns - fresh.facts.uncertainty_ns, ClockId::kMonotonic};
  }
  const int superseded = offer(fresh);
  if (superseded >= 0) camera_->give_back(superseded);
}

int RelayWorker::offer(const Offer& fresh) {
  const Lock lock(mutex_);
  recovery_.image(now_ns());
  health_.state(recovery_.state());
  if (!camera_->free_running()) recovery_.pause(now_ns());
  const Offer old = std::exchange(offer_, fresh);
  for_reader_.notify_all();
  if (!std::exchange(offered_, true)) return -1;
  // Nobody has seen the old one: what was lost before it was lost before this one.
  health_.superseded();
  offer_.facts.lost_before += old.facts.lost_before;
  offer_.facts.first_after_gap = offer_.facts.first_after_gap || old.facts.first_after_gap;
  return old.image.slot;
}

void RelayWorker::fault(ImageFault fault) {
  const Lock lock(mutex_);
  health_.fault(fault, now_ns());
  recovery_.fault(fault, now_ns());
  health_.state(recovery_.state());
}

}  // namespace roomcal::drivers
