#pragma once

#include <array>
#include <cstdint>

#include "drivers/can/dispatcher.h"
#include "drivers/cia402/servo_fault.h"
#include "drivers/cia402/servo_options.h"
#include "drivers/cia402/sync_pairs.h"
#include "runtime/ports/can_bus.h"
#include "runtime/ports/clock.h"

namespace roomcal::drivers::cia402 {

/// Where the table was when a SYNC was on the bus.
struct ServoPosition {
  Stamp on_bus;          ///< of the SYNC: when the drive took its position
  int64_t counts = 0;    ///< as the drive counts, carried on over its 32 bits
  double angle_rad = 0;  ///< of the table, not wrapped
};

/// A CiA 402 servo that turns something: switched on, homed, turned at a steady rate, its positions stamped by SYNC.
///
/// kOff -> kReset -> kIdentify -> kConfigure -> kStart -> kEnable -> (kSelectHoming -> kHome ->) kSelectVelocity ->
/// kReady and kReady -> kTurn -> kStop -> kReady. From every step but kOff a fault leads to kFaulted, where the drive
/// is told to stop at every SYNC; power_on() begins anew. Loss of heartbeat, emergencies and following errors are such
/// faults. If this program dies, the drive misses our heartbeat and stops by itself (1016h, 6007h, where it has them).
///
/// All calls from one thread; no heap. Sources: CiA 301, CiA 402-2 (IEC 61800-7-201).
class Servo final : public CanListener {
 public:
  /// @param bus, clock  outlive the servo. @pre check(options) is ok
  Servo(ports::CanBus& bus, const ports::Clock& clock, const ServoOptions& options);

  /// Begins the way to kReady, from any step; a fault is forgotten.
  void power_on();
  /// @return kUnavailable unless it is ready or turns; kInvalidArgument for a rate that is not a number or above the
  ///         largest. Nothing changes then.
  Status turn(double rate_radps);
  /// Slows down to kReady. Does nothing unless it turns.
  void stop();
  /// Slows down, switches off, gives the node its start-up settings back.
  void power_off();

  /// Does what is due. Call it after the dispatcher, at the SYNC rate or faster.
  void poll();

  std::span<const CanId> ids() const override { return ids_; }
  void hear(const ports::CanMessage& message, const Arrival& arrival) override;

  /// The oldest position that waits. @return false if there is none. The queue holds a second at 100 Hz; a position
  /// that finds it full is lost, and the gap shows in the stamps.
  bool next_position(ServoPosition& position);

  ServoStep step() const { return step_; }
  bool ready() const { return step_ == ServoStep::kReady; }
  /// It turns, and as fast as it was told.
  bool at_speed() const;
  const FaultFacts& fault() const { return fault_; }
  /// One line that names servo, step, fault and remedy; empty without a fault.
  Reason reason() const { return explain(options_.node_id, fault_); }
  const SyncCounters& sync_counters() const { return sync_.counters(); }

 private:
  static constexpr std::size_t kWaiting = 100;

  // servo.cpp: what comes and goes
  void hear_position(const ports::CanMessage& message);
  void hear_heartbeat(const ports::CanMessage& message);
  void hear_emergency(const ports::CanMessage& message);
  void explain_fault(uint16_t code);
  void keep(const Stamp& on_bus, int32_t counts);
  void send_heartbeat(int64_t now_ns);
  void send_cycle();
  void supervise(int64_t now_ns);
  void fail(ServoFault fault);
  bool operating() const { return step_ >= ServoStep::kSelectHoming && step_ <= ServoStep::kStop; }
  DriveState drive() const { return drive_state(status_); }

  // servo_steps.cpp: one step after the other
  void enter(ServoStep step);
  void advance(int64_t now_ns);
  void watch_step_time(int64_t now_ns);
  int64_t time_limit_ns() const;
  ServoFault time_out_fault() const;
  bool transfer(const SetupEntry* write, ObjectKey read, int64_t now_ns);
  void advance_reset(int64_t now_ns);
  void advance_identify(int64_t now_ns);
  void advance_configure(int64_t now_ns);
  void advance_start(int64_t now_ns);
  void advance_enable(int64_t now_ns);
  void advance_mode(Mode mode, ServoStep next, int64_t now_ns);
  void advance_home();
  void advance_stop();
  void advance_power_off();
  void advance_faulted(int64_t now_ns);
  void send_nmt(NmtCommand command) { static_cast<void>(bus_.send(nmt_message(command, options_.node_id))); }

  ports::CanBus& bus_;
  const ports::Clock& clock_;
  ServoOptions options_;
  std::array<CanId, 5> ids_;
  Setup setup_;
  SdoClient sdo_;
  SyncPairs sync_;

  ServoStep step_ = ServoStep::kOff;
  int64_t step_began_ns_ = 0, resend_ns_ = 0, next_heartbeat_ns_ = 0;
  std::size_t task_ = 0;  ///< within the step
  int transfer_tries_ = 0;
  bool syncing_ = false;     ///< SYNC and commands go out
  bool supervised_ = false;  ///< the node's heartbeat is expected
  bool booted_ = false;
  NmtState node_ = NmtState::kBootUp;
  int64_t heard_ns_ = 0;  ///< the node's last heartbeat
  uint16_t control_ = kDisableVoltage;
  int32_t target_ = 0;  ///< velocity units
  uint16_t status_ = 0;
  uint32_t statuses_ = 0;  ///< statuswords since the step began
  FaultFacts fault_;

  bool counted_any_ = false;
  int32_t last_counts_ = 0;
  int64_t counts_ = 0;
  std::array<ServoPosition, kWaiting> waiting_{};
  std::size_t first_ = 0, waiting_count_ = 0;
};

}  // namespace roomcal::drivers::cia402
