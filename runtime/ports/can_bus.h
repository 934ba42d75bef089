#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/base/status.h"
#include "runtime/base/time.h"

namespace roomcal::ports {

/// One CAN or CAN FD data message.
struct CanMessage {
  uint32_t id = 0;        ///< 11 bits, or 29 where `extended`
  bool extended = false;  ///< 0x123 standard and 0x123 extended are different messages
  bool own = false;       ///< sent by this device: `stamp` is when it was on the bus
  uint8_t length = 0;     ///< bytes of `data`
  std::array<uint8_t, 64> data{};
  Stamp stamp;

  std::span<const uint8_t> bytes() const { return {data.data(), length}; }
};

enum class CanState : uint8_t {
  kDown,     ///< the interface is not there or not up
  kActive,   ///< error active: all is well
  kWarning,  ///< many errors
  kPassive,  ///< error passive: too many errors
  kBusOff,   ///< the controller has left the bus
};
/// "down", "active", "warning", "passive", "bus-off".
const char* to_string(CanState state);

struct CanCounters {
  uint64_t received = 0;
  uint64_t sent = 0;            ///< confirmed on the bus
  uint64_t send_refused = 0;    ///< the queue stayed full, or the bus was down
  uint64_t kernel_drops = 0;    ///< receive queue full
  uint64_t error_messages = 0;  ///< that the controller made
  uint64_t bus_offs = 0;
};

/// One CAN interface. All calls from one thread.
class CanBus {
 public:
  virtual ~CanBus() = default;
  /// @return kUnavailable: not sent (queue full after a bounded number of tries, bus down); counted.
  virtual Status send(const CanMessage& message) = 0;
  /// The next message that is waiting, own ones included once they were on the bus. @return false if there is none.
  virtual bool receive(CanMessage& message) = 0;
  virtual CanState state() const = 0;
  virtual const CanCounters& counters() const = 0;
};

}  // namespace roomcal::ports
