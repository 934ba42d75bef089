#pragma once

#include <array>
#include <atomic>
#include <optional>

#include "board/common/shared_stillness.h"
#include "drivers/can/dispatcher.h"
#include "drivers/can/standstill.h"
#include "drivers/can/station.h"
#include "drivers/cia402/servo.h"
#include "runtime/face/vitals.h"
#include "runtime/grab/clock_map.h"
#include "runtime/grab/turntable_tray.h"
#include "runtime/ports/log.h"
#include "runtime/ports/stillness_sensor.h"
#include "runtime/ports/trigger.h"
#include "runtime/press/press.h"
#include "runtime/profile/wiring.h"

namespace roomcal::board {

/// What CAL_STATUS is told, in the runtime's own words.
struct CanStatus {
  bool armed = false;
  press::Moment moment;
  press::Kind kind = press::Kind::kVerify;
  press::Result result = press::Result::kNone;
  press::Trouble trouble = press::Trouble::kNone;
  bool still = false;
  store::State store = store::State::kUncalibrated;
  bool store_damaged = false;
};

/// What somebody on the bus asked for.
enum class CanWish : uint8_t { kNone, kVerify, kCalibrate, kAbort };

/// Everything that hangs on the CAN bus. The supervisor's thread owns it; the session's thread asks it for stillness
/// and triggers through the two ports, which never touch the bus themselves.
class CanSide {
 public:
  /// All outlive it.
  CanSide(ports::CanBus& bus, const ports::SystemClocks& clocks, ports::Log& log)
      : clocks_(clocks), log_(log), bus_(bus), dispatcher_(bus, clocks), stillness_(clocks), trigger_(clocks) {}

  /// Once, before the bus itself is started with ids().
  /// @param seed  of the command nonces, another one at every start.
  /// @return kInvalidArgument for a servo that cannot work; kCapacity.
  Status start(const profile::Wiring& wiring, uint32_t seed);
  /// All that is heard or sent.
  std::span<const drivers::CanId> ids() const { return dispatcher_.ids(); }
  /// The servo turns whenever the tray wants it. @param tray  outlives this side.
  void turn_for(grab::TurntableTray& tray) { tray_ = &tray; }
  bool started() const { return station_.has_value(); }

  /// Supervisor, 50 Hz or more.
  void poll();
  void set_status(const CanStatus& status);
  void announce(const press::Report& report, std::size_t done, std::size_t wanted, double rms_px, uint64_t generation);
  CanWish next_wish();
  /// Whether the wish was granted, for the next CAL_STATUS.
  void answer(Status status);

  const ports::CanBus& bus() const { return bus_; }
  bool has_servo() const { return servo_.has_value(); }
  /// One line that names the servo's fault and the remedy; empty if there is none.
  Reason servo_trouble() const { return servo_ ? servo_->reason() : Reason(); }
  ports::Stillness still_now() const { return still_; }
  bool has_standstill() const { return standstill_.has_value(); }

  /// For the session's thread.
  ports::StillnessSensor& stillness() { return stillness_; }
  ports::Trigger& trigger() { return trigger_; }

 private:
  /// A wish that the supervisor fulfils.
  class SharedTrigger final : public ports::Trigger {
   public:
    explicit SharedTrigger(const ports::SystemClocks& clocks) : clocks_(clocks) {}
    const char* name() const override { return "CAN"; }
    Status fire() override;
    bool wanted() { return wish_.load() == Wish::kWanted; }
    void done(bool sent) { wish_.store(sent ? Wish::kSent : Wish::kFailed); }

   private:
    enum class Wish : uint8_t { kNone, kWanted, kSent, kFailed };
    const ports::SystemClocks& clocks_;
    std::atomic<Wish> wish_{Wish::kNone};
  };

  Status add_servo(const profile::ServoWiring& wiring);
  void turn_table();
  void hand_on_angles();

  const ports::SystemClocks& clocks_;
  ports::Log& log_;
  std::array<char, profile::ShortText::capacity() + 1> interface_{};  ///< ends with a zero; the standstill keeps it
  ports::CanBus& bus_;
  drivers::Dispatcher dispatcher_;
  std::optional<drivers::Station> station_;
  std::optional<drivers::VehicleStandstill> standstill_;
  std::optional<drivers::cia402::Servo> servo_;
  double servo_rate_radps_ = 0;
  grab::TurntableTray* tray_ = nullptr;
  grab::ClockMap bus_clock_;
  bool told_servo_fault_ = false;
  ports::Stillness still_{false, "can: nothing was heard yet"};
  SharedStillness stillness_;
  SharedTrigger trigger_;
  ports::CanState told_state_ = ports::CanState::kActive;
};

}  // namespace roomcal::board
