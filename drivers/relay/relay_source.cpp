#include "drivers/relay/relay_source.h"

#include <utility>

#include "drivers/image/luma.h"
#include "drivers/relay/relay_worker.h"

namespace roomcal::drivers {

namespace {

Status why_none(ports::SourceState state) {
  switch (state) {
    case ports::SourceState::kClosed:
      return {StatusCode::kUnavailable, "the camera is not started"};
    case ports::SourceState::kStreaming:
      return {StatusCode::kUnavailable, "no image in that time"};
    case ports::SourceState::kRecovering:
      return {StatusCode::kUnavailable, "no image: the camera is being brought back, see its log"};
    case ports::SourceState::kFaulted:
      break;
  }
  return {StatusCode::kUnavailable, "no image: the camera has been given up, see its log"};
}

}  // namespace

RelaySource::RelaySource(std::string_view name, const RelayOptions& options, std::unique_ptr<LibraryCamera> camera,
                         const ports::SystemClocks& clocks, ports::Log& log)
    : name_(name),
      options_(options),
      clocks_(clocks),
      log_(log),
      worker_(std::make_unique<RelayWorker>(name, options, std::move(camera), clocks, log)) {}

RelaySource::~RelaySource() { RelaySource::stop(); }

Status RelaySource::start() {
  stop();
  if (!worker_) return {StatusCode::kUnavailable, "the camera's library hangs; restart the program"};
  if (!reserved_) ROOMCAL_TRY(worker_->camera().reserve());
  reserved_ = true;
  ROOMCAL_TRY(worker_->launch());
  running_ = true;
  const Status opened = worker_->first_open(clocks_.now_ns() + options_.start_wait_ns);
  health_ = worker_->health();
  return opened;
}

Status RelaySource::next(int64_t wait_ns, MutableImageView into, ports::ImageFacts& facts) {
  if (!running_) return why_none(ports::SourceState::kClosed);
  RelayWorker::Offer offer;
  if (!worker_->take(clocks_.now_ns() + wait_ns, offer)) {
    health_ = worker_->health();
    return why_none(health_.state);
  }
  const Status copied = to_luma(offer.image.raw, into);
  worker_->release(offer, copied.ok());
  health_ = worker_->health();
  if (copied.ok()) facts = offer.facts;
  return copied;
}

void RelaySource::stop() {
  if (!running_.exchange(false)) return;
  if (worker_->end(clocks_.now_ns() + options_.stop_wait_ns)) {
    health_ = worker_->health();
    return;
  }
  log_.note(name(), "its library does not return and is left behind; restart the program");
  static_cast<void>(worker_.release());  // its thread may come back and use it
  health_.state = ports::SourceState::kFaulted;
}

bool RelaySource::streams() { return running_ && worker_->streams(); }
bool RelaySource::want_fire() { return running_ && worker_->want_fire(); }
bool RelaySource::fired(int64_t deadline_ns) { return running_ && worker_->fired(deadline_ns); }

}  // namespace roomcal::drivers
