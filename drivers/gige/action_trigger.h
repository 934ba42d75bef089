#pragma once

#include <cstdint>

#include <netinet/in.h>

#include "drivers/gige/gvcp.h"
#include "drivers/os/unique_fd.h"
#include "runtime/base/fixed_text.h"
#include "runtime/ports/log.h"
#include "runtime/ports/system_clocks.h"
#include "runtime/ports/trigger.h"

namespace roomcal::drivers {

/// Keys as the cameras' ActionDeviceKey, ActionGroupKey and ActionGroupMask have them.
struct ActionOptions {
  FixedText<15> address = "255.255.255.255";  ///< IPv4: of one camera, of the network's broadcast, or of all
  FixedText<15> local_address = {};           ///< of the interface to send from; empty: as the host routes
  uint16_t port = gvcp::kPort;                ///< another one only for tests
  uint32_t device_key = 0;
  uint32_t group_key = 0;
  uint32_t group_mask = 0xFFFFFFFF;
  int64_t lead_ns = 0;                    ///< expose that long after fire(); 0: on receipt
  ClockId cameras_clock = ClockId::kTai;  ///< that PTP has set the cameras to; only for a lead
  int expected_acknowledgements = 0;      ///< cameras that shall confirm; 0: none is asked to
  int64_t acknowledgement_wait_ns = 20'000'000;
};

/// Since open(); monotone.
struct ActionCounters {
  uint64_t sent = 0;
  uint64_t not_sent = 0;
  uint64_t acknowledged = 0;
  uint64_t refused = 0;  ///< answered with another status than success, see `last_status`
  uint64_t late = 0;     ///< of these: the action time was past; the camera exposed at once, or not at all
  uint64_t missing = 0;  ///< expected and not come in time; the camera may still have exposed
  uint16_t last_status = 0;
};

/// The action command of GigE Vision: one datagram to which all cameras of a group expose, at once (then a switch and
/// each camera's reaction make the spread, some 10 us) or at a time of their common PTP clock (then 1 us).
/// The cameras listen if their trigger source is an action (drivers/aravis does that). Sent once: a datagram that is
/// repeated would expose twice, so a loss shows as images that do not come.
class ActionTrigger final : public ports::Trigger {
 public:
  ActionTrigger(const ActionOptions& options, const ports::SystemClocks& clocks, ports::Log& log);

  /// Before arming. @return kInvalidArgument for an address that is none, a lead without a usable clock; kUnavailable
  /// if the system gives no socket on that interface.
  Status open();

  const char* name() const override { return "action command"; }
  /// Sends, then waits for acknowledgements if some are expected. @return kUnavailable if it could not be sent (no
  /// route, not open, the host does not have the cameras' clock). An acknowledgement that is missing or bad is no
  /// error: the images tell. No heap.
  Status fire() override;

  const ActionCounters& counters() const { return counters_; }
  /// When the cameras were told to expose, by the last fire(); clock kUnknown if at once.
  Stamp action_time() const { return action_time_; }

 private:
  Status schedule(gvcp::ActionCommand& command);
  void collect(uint16_t id);
  bool receive(uint16_t id);
  void note_refusal(uint16_t status);

  ActionOptions options_;
  const ports::SystemClocks& clocks_;
  ports::Log& log_;
  UniqueFd socket_;
  sockaddr_in to_{};
  uint16_t last_id_ = 0;
  ActionCounters counters_;
  Stamp action_time_;
};

}  // namespace roomcal::drivers
