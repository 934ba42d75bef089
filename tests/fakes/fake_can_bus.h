#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "runtime/ports/can_bus.h"
#include "runtime/ports/system_clocks.h"

namespace roomcal::fakes {

/// Where something else on the bus puts its messages.
class CanWire {
 public:
  virtual ~CanWire() = default;
  /// A message of somebody else than the device, on the bus now or a little later.
  virtual void deliver(ports::CanMessage message, int64_t after_ns = 0) = 0;
};

/// Something else on the bus: hears what the device sends, answers by its wire.
class CanNode {
 public:
  virtual ~CanNode() = default;
  virtual void on_bus(const ports::CanMessage& message) = 0;
};

/// A bus with the device at one end and a test at the other. What the device sends is on the bus at once, confirmed,
/// and heard by all nodes, unless the script says otherwise.
class FakeCanBus final : public ports::CanBus, public CanWire {
 public:
  explicit FakeCanBus(const ports::SystemClocks& clocks) : clocks_(clocks) {}

  Status send(const ports::CanMessage& message) override;
  bool receive(ports::CanMessage& message) override;
  ports::CanState state() const override { return state_; }
  const ports::CanCounters& counters() const override { return counters_; }

  void attach(CanNode& node) { nodes_.push_back(&node); }
  void deliver(ports::CanMessage message, int64_t after_ns = 0) override;
  /// All that was sent and not refused, in order.
  const std::vector<ports::CanMessage>& sent() const { return sent_; }
  void forget_sent() { sent_.clear(); }

  void set_state(ports::CanState state);
  int refuse = 0;             ///< so many sends from now on are refused
  bool confirms = true;       ///< false: sent messages never come back
  bool reaches = true;        ///< false: nodes hear nothing
  int64_t send_delay_ns = 0;  ///< from send() to the bus: moves the stamp only

 private:
  Stamp stamp_now() const { return clocks_.read(ClockId::kRealtime); }

  const ports::SystemClocks& clocks_;
  std::vector<CanNode*> nodes_;
  std::deque<ports::CanMessage> queue_;
  std::vector<ports::CanMessage> sent_;
  ports::CanState state_ = ports::CanState::kActive;
  ports::CanCounters counters_;
};

}  // namespace roomcal::fakes
