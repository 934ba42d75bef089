#include "drivers/can/dispatcher.h"

#include <algorithm>

namespace roomcal::drivers {

namespace {

constexpr std::size_t kMaxAtOnce = 512;

bool wants(const CanListener& listener, const CanId& id) {
  const auto ids = listener.ids();
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

}  // namespace

bool Dispatcher::add_id(const CanId& id) {
  return std::find(ids_.begin(), ids_.end(), id) != ids_.end() || ids_.push_back(id);
}

Status Dispatcher::add(CanListener& listener) {
  const std::size_t before = ids_.size();
  bool fits = !listeners_.full();
  for (const CanId& id : listener.ids()) fits = fits && add_id(id);
  if (!fits) {
    ids_.truncate(before);
    return {StatusCode::kCapacity, "too many take part on one CAN bus; spread them over two"};
  }
  return listeners_.push_back(&listener) ? ok_status() : Status{StatusCode::kCapacity, "too many CAN listeners"};
}

std::size_t Dispatcher::poll() {
  ports::CanMessage message;
  for (std::size_t taken = 0; taken < kMaxAtOnce; ++taken) {
    const int64_t asked_ns = clock_.now_ns();
    if (!bus_.receive(message)) {
      empty_ns_ = asked_ns;
      return taken;
    }
    const Arrival arrival{empty_ns_, clock_.now_ns()};
    const CanId id{message.id, message.extended};
    for (CanListener* listener : listeners_)
      if (wants(*listener, id)) listener->hear(message, arrival);
  }
  return kMaxAtOnce;
}

}  // namespace roomcal::drivers
