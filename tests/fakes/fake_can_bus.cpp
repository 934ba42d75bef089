#include "tests/fakes/fake_can_bus.h"

namespace roomcal::fakes {

Status FakeCanBus::send(const ports::CanMessage& message) {
  const bool down = state_ == ports::CanState::kDown || state_ == ports::CanState::kBusOff;
  if (down || refuse > 0) {
    if (refuse > 0) --refuse;
    ++counters_.send_refused;
    return {StatusCode::kUnavailable, "the fake bus refuses"};
  }
  ports::CanMessage on_bus = message;
  on_bus.stamp = stamp_now();
  on_bus.stamp.ns += send_delay_ns;
  on_bus.own = true;
  sent_.push_back(on_bus);
  if (confirms) queue_.push_back(on_bus);
  for (CanNode* node : nodes_)
    if (reaches) node->on_bus(on_bus);
  return ok_status();
}

bool FakeCanBus::receive(ports::CanMessage& message) {
  if (queue_.empty()) return false;
  message = queue_.front();
  queue_.pop_front();
  ++(message.own ? counters_.sent : counters_.received);
  return true;
}

void FakeCanBus::deliver(ports::CanMessage message, int64_t after_ns) {
  message.stamp = stamp_now();
  message.stamp.ns += after_ns;
  message.own = false;
  queue_.push_back(message);
}

void FakeCanBus::set_state(ports::CanState state) {
  if (state == ports::CanState::kBusOff && state_ != state) ++counters_.bus_offs;
  state_ = state;
}

}  // namespace roomcal::fakes
