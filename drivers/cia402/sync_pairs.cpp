#include "drivers/cia402/sync_pairs.h"

namespace roomcal::drivers::cia402 {

void SyncPairs::restart(int64_t now_ns) {
  state_ = State::kIdle;
  next_ns_ = confirmed_ns_ = now_ns;
  unanswered_ = 0;
}

bool SyncPairs::due(int64_t now_ns) {
  if (now_ns < next_ns_) return false;
  // In step with the period, unless whole periods were missed.
  next_ns_ += period_ns_;
  if (next_ns_ <= now_ns) next_ns_ = now_ns + period_ns_;
  if (state_ == State::kSent) {
    ++counters_.skipped;
    return false;
  }
  leave_unanswered();
  return true;
}

void SyncPairs::leave_unanswered() {
  if (state_ != State::kConfirmed) return;
  ++counters_.unanswered;
  ++unanswered_;
  state_ = State::kIdle;
}

void SyncPairs::disturbed() { leave_unanswered(); }

void SyncPairs::sent(bool ok) {
  ++(ok ? counters_.sent : counters_.refused);
  if (ok) state_ = State::kSent;
}

void SyncPairs::confirmed(const Stamp& on_bus, int64_t now_ns) {
  if (state_ != State::kSent) return;
  ++counters_.confirmed;
  state_ = State::kConfirmed;
  on_bus_ = on_bus;
  confirmed_ns_ = now_ns;
}

bool SyncPairs::pair(const Stamp& answered, Stamp& on_bus) {
  const int64_t after_ns = answered.ns - on_bus_.ns;
  if (state_ != State::kConfirmed || !comparable(answered, on_bus_) || after_ns < 0 || after_ns > period_ns_ / 2) {
    ++counters_.unasked;
    return false;
  }
  on_bus = on_bus_;
  state_ = State::kIdle;
  unanswered_ = 0;
  return true;
}

}  // namespace roomcal::drivers::cia402
