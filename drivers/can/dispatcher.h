#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "runtime/base/fixed_vector.h"
#include "runtime/ports/can_bus.h"
#include "runtime/ports/clock.h"

namespace roomcal::drivers {

/// An identifier on the bus: 0x123 standard and 0x123 extended are different ones.
struct CanId {
  uint32_t id = 0;
  bool extended = false;

  friend bool operator==(const CanId&, const CanId&) = default;
};

/// When a message came, monotonic: after `earliest_ns`, before `latest_ns`.
///
/// The kernel's own stamp is of the realtime clock, which may be set at any moment. The bounds need no other clock: the
/// queue was empty at `earliest_ns`.
struct Arrival {
  int64_t earliest_ns = 0;
  int64_t latest_ns = 0;
};

/// Somebody who takes part on a bus.
class CanListener {
 public:
  virtual ~CanListener() = default;
  /// What it hears, and what it sends and wants confirmed. The same throughout.
  virtual std::span<const CanId> ids() const = 0;
  /// A message with one of its identifiers, its own ones (`own`) included. May send.
  virtual void hear(const ports::CanMessage& message, const Arrival& arrival) = 0;
};

inline constexpr std::size_t kMaxListeners = 8;
inline constexpr std::size_t kMaxCanIds = 64;

/// Hands the messages of one bus to those who want them.
class Dispatcher {
 public:
  /// Both outlive the dispatcher.
  Dispatcher(ports::CanBus& bus, const ports::Clock& clock) : bus_(bus), clock_(clock) {}

  /// @param listener  outlives the dispatcher.
  /// @return kCapacity for too many listeners or identifiers; nothing is added then.
  Status add(CanListener& listener);
  /// Of all listeners, each once: what a socket's filters let through.
  std::span<const CanId> ids() const { return ids_.span(); }

  /// Takes what has come, at most 512 messages, which a full bus of 1 Mbit/s needs 60 ms for. Does not wait; no heap.
  /// @return how many.
  std::size_t poll();

 private:
  bool add_id(const CanId& id);

  ports::CanBus& bus_;
  const ports::Clock& clock_;
  FixedVector<CanListener*, kMaxListeners> listeners_;
  FixedVector<CanId, kMaxCanIds> ids_;
  /// When the queue was seen empty for the last time; before the first time nothing is known of any arrival.
  int64_t empty_ns_ = std::numeric_limits<int64_t>::min() / 2;
};

}  // namespace roomcal::drivers
