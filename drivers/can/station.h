#pragma once

#include <array>
#include <cstdint>

#include "drivers/can/dispatcher.h"
#include "drivers/can/roomcal_dbc_generated.h"
#include "runtime/base/verdict.h"
#include "runtime/ports/trigger.h"

namespace roomcal::drivers {

/// What CAL_STATUS tells; every value's meaning is in roomcal.dbc.
struct CalStatus {
  dbc::cal_status::State state = dbc::cal_status::State::kStarting;
  dbc::cal_status::Step step = dbc::cal_status::Step::kNone;
  double progress_percent = 0;
  dbc::cal_status::Reason reason = dbc::cal_status::Reason::kNone;
  bool stationary = false;
  dbc::cal_status::Store store = dbc::cal_status::Store::kUncalibrated;
};

/// How a run ended, for CAL_RESULT.
struct CalResult {
  bool aborted = false;
  Verdict verdict = Verdict::kFailService;  ///< unless aborted
  bool verify_only = false;
  std::size_t sensors_done = 0, sensors_wanted = 0;
  double rms_px = 0;
  uint64_t generation = 0;  ///< of the record in force
};

/// A CAL_CMD that was taken: fresh, whole, and not heard before.
struct CalCommand {
  dbc::cal_cmd::Command command = dbc::cal_cmd::Command::kNone;
  Arrival arrival;
};

/// A CAL_TRIGGER_IN, or our own CAL_TRIGGER once it was on the bus.
struct TriggerMark {
  uint8_t id = 0;
  double sender_s = 0;  ///< the sender's clock, modulo 203 days
  Stamp on_bus;
};

/// Since the start; monotone.
struct StationCounters {
  uint64_t status_sent = 0, status_refused = 0;
  uint64_t results_sent = 0, results_given_up = 0;
  uint64_t commands = 0;          ///< taken
  uint64_t repeated = 0;          ///< commands that were taken already
  uint64_t stale = 0;             ///< with a nonce that is not in force
  uint64_t unknown_commands = 0;  ///< of a number that the DBC file does not have
  uint64_t damaged = 0;           ///< checksum, counter or length
  uint64_t crowded_out = 0;       ///< commands and marks that nobody fetched in time
};

/// The device's side of roomcal.dbc: says how it is, hears what others want. All calls from one thread, the one that is
/// supervised: when it hangs, CAL_STATUS stops.
class Station final : public CanListener, public ports::Trigger {
 public:
  /// @param bus, clock  outlive the station.
  /// @param seed  of the nonces; another one at every start, or a recording of the last start opens the door again.
  Station(ports::CanBus& bus, const ports::Clock& clock, uint32_t seed);

  void set_status(const CalStatus& status) { status_ = status; }
  /// Sends CAL_STATUS where it is due, every 100 ms, and a result again that was not confirmed. Call it at 50 Hz or
  /// more.
  void poll();
  /// Sends CAL_RESULT, and again every 100 ms until it was on the bus, for 5 s.
  void announce(const CalResult& result);
  /// What the board made of the last command, for CAL_STATUS.
  void answer(dbc::cal_status::CommandAnswer answer) { answer_ = answer; }

  /// The oldest command that waits. @return false if there is none.
  bool next_command(CalCommand& command);
  /// The oldest CAL_TRIGGER_IN that waits. @return false if there is none.
  bool next_mark(TriggerMark& mark);

  const char* name() const override { return "CAN"; }
  /// Sends CAL_TRIGGER.
  /// @return kUnavailable if it was not sent.
  Status fire() override;
  /// Our last CAL_TRIGGER that was confirmed. @return false before the first one.
  bool last_fired(TriggerMark& mark) const;

  std::span<const CanId> ids() const override;
  void hear(const ports::CanMessage& message, const Arrival& arrival) override;
  const StationCounters& counters() const { return counters_; }

 private:
  struct Pending {
    bool waits = false;
    ports::CanMessage message;
    int64_t next_ns = 0, until_ns = 0;
  };

  void send_status();
  void renew_nonce(int64_t now_ns);
  void repeat_result(int64_t now_ns);
  void hear_command(const ports::CanMessage& message, const Arrival& arrival);
  void hear_mark(const ports::CanMessage& message);
  void hear_own(const ports::CanMessage& message);

  ports::CanBus& bus_;
  const ports::Clock& clock_;
  CalStatus status_;
  dbc::cal_status::CommandAnswer answer_ = dbc::cal_status::CommandAnswer::kNone;
  int64_t next_status_ns_, next_nonce_ns_;
  uint32_t nonce_, nonce_before_;  ///< both are in force; equal: only one is
  bool took_any_ = false;
  uint32_t taken_nonce_ = 0;
  uint8_t status_counter_ = 0, result_counter_ = 0, trigger_counter_ = 0, trigger_id_ = 0;
  Pending result_;
  FixedVector<CalCommand, 4> commands_;
  FixedVector<TriggerMark, 16> marks_;
  bool fired_any_ = false;
  TriggerMark fired_;
  StationCounters counters_;
};

}  // namespace roomcal::drivers
