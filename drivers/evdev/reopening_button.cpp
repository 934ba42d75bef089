#include "drivers/evdev/reopening_button.h"

namespace roomcal::drivers {

namespace {

constexpr int kMaxEvents = 64;  // looked at in one next(): a device that floods does not hold the loop up

}  // namespace

Status ReopeningButton::start() {
  stop();
  wanted_ = true;
  bool held = false;
  const Status opened = open(held);
  started_ = opened.ok();
  filter_.start(held);
  static_cast<void>(retry_.due(now_ns()));
  return opened;
}

void ReopeningButton::stop() {
  wanted_ = false;
  close();
}

bool ReopeningButton::come_back(ports::ButtonEdge& edge) {
  bool held = false;
  if (!wanted_ || !retry_.due(now_ns()) || !open(held).ok()) return false;
  if (started_) return filter_.take(held, now_ns(), edge);
  started_ = true;
  filter_.start(held);
  return false;
}

bool ReopeningButton::next(ports::ButtonEdge& edge) {
  if (fd() < 0) return come_back(edge);
  for (int i = 0; i < kMaxEvents; ++i) {
    Reading reading;
    if (!read(reading)) return false;
    if (reading.tells && filter_.take(reading.down, reading.stamp_ns, edge)) return true;
  }
  return false;
}

}  // namespace roomcal::drivers
