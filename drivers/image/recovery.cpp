#include "drivers/image/recovery.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace roomcal::drivers {

using ports::ImageFault;
using ports::SourceState;

namespace {

constexpr int64_t kNever = std::numeric_limits<int64_t>::max();

enum class Kind : uint8_t { kNote, kImage, kStream, kDevice, kAbsent, kHopeless };

Kind kind_of(ImageFault fault) {
  switch (fault) {
    case ImageFault::kStampFuture:
    case ImageFault::kStampBackwards:
    case ImageFault::kStampFrozen:
    case ImageFault::kStampOld:
    case ImageFault::kStampTai:
    case ImageFault::kStampUnknown:
    case ImageFault::kCount:
      return Kind::kNote;
    case ImageFault::kMarkedDamaged:
    case ImageFault::kShort:
    case ImageFault::kUndecodable:
    case ImageFault::kTransient:
      return Kind::kImage;
    case ImageFault::kStall:
    case ImageFault::kEndOfStream:
    case ImageFault::kUnknownBuffer:
      return Kind::kStream;
    case ImageFault::kStale:
    case ImageFault::kNoMemory:
    case ImageFault::kNoBandwidth:
      return Kind::kDevice;
    case ImageFault::kGone:
    case ImageFault::kNotFound:
    case ImageFault::kBusy:
    case ImageFault::kDenied:
      return Kind::kAbsent;
    case ImageFault::kFormat:
      return Kind::kHopeless;
  }
  return Kind::kNote;
}

}  // namespace

bool is_absence(ImageFault fault) { return kind_of(fault) == Kind::kAbsent; }

const char* to_string(RecoveryStep step) {
  constexpr std::array<const char*, 6> kNames = {"watch",      "restart stream", "reopen",
                                                 "reset port", "stay closed",    "give up"};
  const auto i = static_cast<std::size_t>(step);
  return i < kNames.size() ? kNames[i] : "unknown";
}

void Recovery::start(int64_t now_ns) {
  *this = Recovery(options_);
  fill_budget();
  plan(RecoveryStep::kReopen, now_ns);
  trouble_ = false;
  well_since_ns_ = now_ns;
  pause(now_ns);
}

void Recovery::begun(int64_t now_ns) {
  if (state_ != State::kOpening) return;
  state_ = State::kWatching;
  watch_until_ns_ = now_ns + options_.first_image_ns;
  paused_at_ns_ = now_ns;  // what was before does not lengthen the watch
}

void Recovery::port_reset(int64_t now_ns) {
  if (state_ == State::kOpening) plan(RecoveryStep::kReopen, now_ns + options_.shortest_wait_ns);
}

void Recovery::image(int64_t now_ns) {
  if (state_ != State::kWatching) return;
  if (absent_) fill_budget();
  if (trouble_) well_since_ns_ = now_ns;
  if (now_ns - well_since_ns_ >= options_.healthy_ns) fill_budget();
  trouble_ = absent_ = false;
  damaged_ = 0;
  next_wait_ns_ = options_.shortest_wait_ns;
  watch_until_ns_ = now_ns + options_.stall_ns;
}

void Recovery::fault(ImageFault fault, int64_t now_ns) {
  if (state_ == State::kClosed || state_ == State::kGivenUp) return;
  switch (kind_of(fault)) {
    case Kind::kNote:
      return;
    case Kind::kImage:
      return image_damaged(now_ns);
    case Kind::kStream:
      return stream_failed(now_ns);
    case Kind::kDevice:
      return device_failed(now_ns);
    case Kind::kAbsent:
      // Only a camera that was unplugged lost its power: the past of others is not forgiven.
      absent_ = absent_ || fault == ImageFault::kGone || fault == ImageFault::kNotFound;
      return camera_absent(now_ns);
    case Kind::kHopeless:
      state_ = State::kGivenUp;
  }
}

// Images that come, though damaged, show that the stream runs: the watchdog has no say then.
void Recovery::image_damaged(int64_t now_ns) {
  if (state_ == State::kOpening || ++damaged_ >= options_.damaged_in_a_row) return stream_failed(now_ns);
  watch_until_ns_ = std::max(watch_until_ns_, now_ns + options_.stall_ns);
}

void Recovery::stream_failed(int64_t now_ns) {
  if (state_ == State::kOpening || restarts_left_ == 0) return device_failed(now_ns);
  --restarts_left_;
  plan(RecoveryStep::kRestartStream, now_ns);
}

void Recovery::device_failed(int64_t now_ns) {
  if (reopens_left_ > 0) {
    const bool first = reopens_left_-- == options_.reopens;
    return plan(RecoveryStep::kReopen, first ? now_ns : now_ns + options_.shortest_wait_ns);
  }
  if (reset_left_) {
    reset_left_ = false;
    return plan(RecoveryStep::kResetPort, now_ns);
  }
  state_ = State::kGivenUp;
}

void Recovery::camera_absent(int64_t now_ns) {
  plan(RecoveryStep::kReopen, now_ns + next_wait_ns_);
  next_wait_ns_ = std::min(2 * next_wait_ns_, options_.longest_wait_ns);
}

void Recovery::plan(RecoveryStep step, int64_t at_ns) {
  state_ = State::kOpening;
  step_ = step;
  step_at_ns_ = at_ns;
  damaged_ = 0;
  trouble_ = true;
}

void Recovery::fill_budget() {
  restarts_left_ = options_.restarts;
  reopens_left_ = options_.reopens;
  reset_left_ = options_.may_reset_port;
  next_wait_ns_ = options_.shortest_wait_ns;
}

void Recovery::resume(int64_t now_ns) {
  if (paused_ && now_ns > paused_at_ns_) watch_until_ns_ += now_ns - paused_at_ns_;
  paused_ = false;
}

void Recovery::pause(int64_t now_ns) {
  if (!paused_) paused_at_ns_ = now_ns;
  paused_ = true;
}

RecoveryOrder Recovery::order(int64_t now_ns) const {
  switch (state_) {
    case State::kWatching:
      return {RecoveryStep::kWatch, watch_until_ns_};
    case State::kOpening:
      if (now_ns < step_at_ns_) return {RecoveryStep::kStayClosed, step_at_ns_};
      return {step_, now_ns};
    case State::kClosed:
    case State::kGivenUp:
      break;
  }
  return {RecoveryStep::kGiveUp, kNever};
}

bool Recovery::stalled(int64_t now_ns) const {
  return state_ == State::kWatching && !paused_ && now_ns >= watch_until_ns_;
}

SourceState Recovery::state() const {
  switch (state_) {
    case State::kClosed:
      return SourceState::kClosed;
    case State::kOpening:
      return SourceState::kRecovering;
    case State::kWatching:
      return trouble_ ? SourceState::kRecovering : SourceState::kStreaming;
    case State::kGivenUp:
      break;
  }
  return SourceState::kFaulted;
}

}  // namespace roomcal::drivers
