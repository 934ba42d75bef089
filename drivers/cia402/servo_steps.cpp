// The steps of a servo's life, one function each.

#include "drivers/cia402/servo.h"

namespace roomcal::drivers::cia402 {

namespace {

constexpr int64_t kSecond_ns = 1'000'000'000;
constexpr int64_t kResendReset_ns = kSecond_ns, kResendStart_ns = kSecond_ns / 2;
constexpr int64_t kResetPulse_ns = kSecond_ns / 10;
constexpr int kTransferTries = 3;
constexpr uint32_t kDriveProfile = 402;
// Statuswords after which one tells of the command: it was on the way when the command came.
constexpr uint32_t kSettled = 5;

}  // namespace

void Servo::enter(ServoStep step) {
  const ServoStep before = step_;
  step_ = step;
  step_began_ns_ = clock_.now_ns();
  resend_ns_ = 0;
  task_ = 0;
  transfer_tries_ = 0;
  statuses_ = 0;
  sdo_.reset();
  target_ = 0;
  if (step == ServoStep::kReset) {
    syncing_ = supervised_ = booted_ = counted_any_ = false;
    fault_ = {};
    waiting_count_ = 0;
    control_ = kDisableVoltage;
  } else if (step == ServoStep::kStart) {
    syncing_ = supervised_ = true;
    heard_ns_ = step_began_ns_;
    sync_.restart(step_began_ns_);
  } else if (step == ServoStep::kHome) {
    control_ = kEnableOperation | kStartHoming;
  } else if (step == ServoStep::kPowerOff) {
    // A table that turns is stopped before it is let loose.
    task_ = before == ServoStep::kTurn || before == ServoStep::kStop ? 0 : 1;
    supervised_ = false;
  } else if (step == ServoStep::kFaulted) {
    control_ = kQuickStop;
    supervised_ = false;
  } else if (step > ServoStep::kEnable) {
    control_ = kEnableOperation;
  }
}

int64_t Servo::time_limit_ns() const {
  switch (step_) {
    case ServoStep::kReset:
    case ServoStep::kEnable:
      return 5 * kSecond_ns;
    case ServoStep::kStart:
    case ServoStep::kSelectHoming:
    case ServoStep::kSelectVelocity:
      return 2 * kSecond_ns;
    case ServoStep::kHome:
      return options_.homing_timeout_ns;
    case ServoStep::kStop:
    case ServoStep::kPowerOff:
      return 2 * kSecond_ns +
             static_cast<int64_t>(options_.max_speed_radps / options_.acceleration_radps2 * kSecond_ns);
    default:
      return 0;  // its transfers have limits of their own, or it may take for ever
  }
}

ServoFault Servo::time_out_fault() const {
  switch (step_) {
    case ServoStep::kReset:
      return ServoFault::kNoBoot;
    case ServoStep::kStart:
      return node_ == NmtState::kOperational ? ServoFault::kNoPosition : ServoFault::kNotStarted;
    case ServoStep::kEnable:
      return drive() == DriveState::kFault ? ServoFault::kDriveFault : ServoFault::kNotEnabled;
    case ServoStep::kHome:
      return ServoFault::kHomingTimeout;
    case ServoStep::kStop:
      return ServoFault::kNotStopped;
    default:
      return ServoFault::kModeRefused;
  }
}

void Servo::watch_step_time(int64_t now_ns) {
  const int64_t limit_ns = time_limit_ns();
  if (limit_ns == 0 || now_ns - step_began_ns_ <= limit_ns) return;
  if (step_ == ServoStep::kPowerOff) {
    task_ = 2;  // off it goes, whatever the drive says
  } else {
    fail(time_out_fault());
  }
}

void Servo::advance(int64_t now_ns) {
  switch (step_) {
    case ServoStep::kReset:
      return advance_reset(now_ns);
    case ServoStep::kIdentify:
      return advance_identify(now_ns);
    case ServoStep::kConfigure:
      return advance_configure(now_ns);
    case ServoStep::kStart:
      return advance_start(now_ns);
    case ServoStep::kEnable:
      return advance_enable(now_ns);
    case ServoStep::kSelectHoming:
      return advance_mode(Mode::kHoming, ServoStep::kHome, now_ns);
    case ServoStep::kHome:
      return advance_home();
    case ServoStep::kSelectVelocity:
      return advance_mode(Mode::kProfileVelocity, ServoStep::kReady, now_ns);
    case ServoStep::kStop:
      return advance_stop();
    case ServoStep::kPowerOff:
      return advance_power_off();
    case ServoStep::kFaulted:
      return advance_faulted(now_ns);
    default:
      return;
  }
}

/// One transfer: begun, waited for, tried again. @param write  nullptr: `read` is read.
/// @return true once it is over and well, or was refused and is optional.
bool Servo::transfer(const SetupEntry* write, ObjectKey read, int64_t now_ns) {
  const auto begin = [&] {
    if (write != nullptr) return sdo_.download(write->key, write->value, write->bytes, now_ns);
    sdo_.upload(read, now_ns);
  };
  const auto over = [&] {
    sdo_.reset();
    transfer_tries_ = 0;
    return true;
  };
  switch (sdo_.state()) {
    case SdoState::kIdle:
      begin();
      return false;
    case SdoState::kBusy:
      return false;
    case SdoState::kDone:
      return over();
    case SdoState::kAborted:
      if (write != nullptr && write->optional) return over();
      fail(ServoFault::kSdoAbort);
      return false;
    default:
      if (++transfer_tries_ < kTransferTries) {
        begin();
      } else {
        fail(ServoFault::kSdoTimeout);
      }
      return false;
  }
}

void Servo::advance_reset(int64_t now_ns) {
  if (booted_) return enter(ServoStep::kIdentify);
  if (now_ns < resend_ns_) return;
  resend_ns_ = now_ns + kResendReset_ns;
  send_nmt(NmtCommand::kResetNode);
}

void Servo::advance_identify(int64_t now_ns) {
  if (!transfer(nullptr, task_ == 0 ? kDeviceType : kSupportedModes, now_ns)) return;
  if (task_++ == 0) {
    if ((sdo_.value() & 0xFFFF) != kDriveProfile) fail(ServoFault::kNotADrive);
    return;
  }
  const uint32_t wanted =
      supports(Mode::kProfileVelocity) | (options_.homing_method != 0 ? supports(Mode::kHoming) : 0);
  if ((sdo_.value() & wanted) != wanted) return fail(ServoFault::kNoSuchMode);
  enter(ServoStep::kConfigure);
}

void Servo::advance_configure(int64_t now_ns) {
  if (!transfer(&setup_[task_], {}, now_ns)) return;
  if (++task_ == setup_.size()) enter(ServoStep::kStart);
}

void Servo::advance_start(int64_t now_ns) {
  if (node_ == NmtState::kOperational && statuses_ > 0) return enter(ServoStep::kEnable);
  if (now_ns < resend_ns_) return;
  resend_ns_ = now_ns + kResendStart_ns;
  send_nmt(NmtCommand::kStart);
}

void Servo::advance_enable(int64_t now_ns) {
  if (statuses_ == 0) return;
  const DriveState state = drive();
  control_ = command_towards_operation(state);
  // The reset acts on the rising edge, so it is given in pulses.
  const bool pulse = (now_ns - step_began_ns_) / kResetPulse_ns % 2 != 0;
  if (state == DriveState::kFault && pulse) control_ = kFaultReset;
  if (state != DriveState::kOperationEnabled) return;
  fault_.emergency = 0;  // whatever it was, the drive is over it
  enter(options_.homing_method != 0 ? ServoStep::kSelectHoming : ServoStep::kSelectVelocity);
}

void Servo::advance_mode(Mode mode, ServoStep next, int64_t now_ns) {
  const SetupEntry choose{kModeOfOperation, static_cast<uint8_t>(mode), 1};
  if (!transfer(task_ == 0 ? &choose : nullptr, kModeDisplay, now_ns)) return;
  if (task_ == 0) {
    task_ = 1;
  } else if ((sdo_.value() & 0xFF) == static_cast<uint8_t>(mode)) {
    enter(next);
  }
}

void Servo::advance_home() {
  if (statuses_ < kSettled) return;
  if ((status_ & kHomingError) != 0) return fail(ServoFault::kHomingFailed);
  if ((status_ & kHomingAttained) != 0 && (status_ & kTargetReached) != 0) enter(ServoStep::kSelectVelocity);
}

void Servo::advance_stop() {
  if (statuses_ >= kSettled && (status_ & kStandsStill) != 0) enter(ServoStep::kReady);
}

/// Stop (0), take the power off (1), let the node go (2).
void Servo::advance_power_off() {
  if (!syncing_) task_ = 2;
  if (task_ == 0 && statuses_ >= kSettled &&
      ((status_ & kStandsStill) != 0 || drive() != DriveState::kOperationEnabled))
    task_ = 1;
  if (task_ == 1) {
    control_ = kShutdown;
    if (statuses_ >= kSettled && drive() != DriveState::kOperationEnabled) task_ = 2;
  }
  if (task_ != 2) return;
  syncing_ = false;
  // Back to its start-up settings: without our heartbeat it would report a fault otherwise.
  send_nmt(NmtCommand::kResetCommunication);
  enter(ServoStep::kOff);
}

/// SYNC and command reach only a node that is operational; an SDO also one that somebody stopped.
void Servo::advance_faulted(int64_t now_ns) {
  const SetupEntry stop{kControlword, kQuickStop, 2, true};
  if (task_ == 0 && transfer(&stop, {}, now_ns)) task_ = 1;
}

}  // namespace roomcal::drivers::cia402
