#include "board/common/can_side.h"

#include <algorithm>

namespace roomcal::board {

namespace {

namespace cal_status = drivers::dbc::cal_status;

constexpr int64_t kTriggerWait_ns = 200'000'000;

cal_status::State state_of(const CanStatus& status) {
  if (!status.armed) return cal_status::State::kService;
  if (status.moment.state == press::State::kIdle) return cal_status::State::kIdle;
  return status.kind == press::Kind::kVerify ? cal_status::State::kVerifying : cal_status::State::kCalibrating;
}

cal_status::Step step_of(press::State state) {
  switch (state) {
    case press::State::kIdle:
      return cal_status::Step::kNone;
    case press::State::kWaitStill:
      return cal_status::Step::kWaitStill;
    case press::State::kGrab:
      return cal_status::Step::kGrab;
    case press::State::kDetect:
      return cal_status::Step::kDetect;
    case press::State::kLocate:
    case press::State::kLocateLidars:
      return cal_status::Step::kLocate;
    case press::State::kSolve:
      return cal_status::Step::kSolve;
    case press::State::kJudge:
      return cal_status::Step::kJudge;
    case press::State::kWrite:
    case press::State::kCheck:
      return cal_status::Step::kWrite;
  }
  return cal_status::Step::kNone;
}

cal_status::Reason reason_of(const CanStatus& status) {
  if (status.result == press::Result::kAborted) return cal_status::Reason::kAborted;
  switch (status.trouble) {
    case press::Trouble::kNone:
      return cal_status::Reason::kNone;
    case press::Trouble::kImages:
      return cal_status::Reason::kImageQuality;
    case press::Trouble::kMotion:
      return cal_status::Reason::kMoving;
    case press::Trouble::kPlace:
      return cal_status::Reason::kTooFewMarkers;
    case press::Trouble::kLidar:
      return cal_status::Reason::kLidarFault;
    case press::Trouble::kService:
      return cal_status::Reason::kDoesNotFit;
    case press::Trouble::kStore:
      return cal_status::Reason::kStoreFault;
    case press::Trouble::kDevice:
      return cal_status::Reason::kInternal;
  }
  return cal_status::Reason::kInternal;
}

cal_status::Store store_of(const CanStatus& status) {
  if (status.store == store::State::kUncalibrated)
    return status.store_damaged ? cal_status::Store::kDamaged : cal_status::Store::kUncalibrated;
  return status.store == store::State::kFactory ? cal_status::Store::kFactory : cal_status::Store::kCalibrated;
}

}  // namespace

Status CanSide::SharedTrigger::fire() {
  wish_.store(Wish::kWanted);
  const int64_t deadline_ns = clocks_.now_ns() + kTriggerWait_ns;
  while (clocks_.now_ns() < deadline_ns) {
    Wish sent = Wish::kSent, failed = Wish::kFailed;
    if (wish_.compare_exchange_strong(sent, Wish::kNone)) return ok_status();
    if (wish_.compare_exchange_strong(failed, Wish::kNone)) break;
    clocks_.sleep_until(clocks_.now_ns() + 1'000'000);
  }
  wish_.store(Wish::kNone);
  return {StatusCode::kUnavailable, "CAL_TRIGGER could not be sent: check the bus"};
}

Status CanSide::add_servo(const profile::ServoWiring& wiring) {
  drivers::cia402::ServoOptions options;
  options.node_id = wiring.node;
  options.counts_per_turn = wiring.counts_per_turn;
  options.velocity_units_per_count = wiring.velocity_units_per_count;
  options.acceleration_units_per_count = wiring.acceleration_units_per_count;
  options.homing_method = wiring.homing_method;
  ROOMCAL_TRY(check(options));
  servo_rate_radps_ = kPi / wiring.half_turn_s;
  servo_.emplace(bus_, clocks_, options);
  return dispatcher_.add(*servo_);
}

Status CanSide::start(const profile::Wiring& all, uint32_t seed) {
  const profile::CanWiring& wiring = all.can;
  const std::string_view interface = wiring.interface.view();
  std::copy(interface.begin(), interface.end(), interface_.begin());
  station_.emplace(bus_, clocks_, seed);
  ROOMCAL_TRY(dispatcher_.add(*station_));
  if (wiring.standstill) {
    drivers::StandstillOptions options;
    options.bus_name = interface_.data();
    standstill_.emplace(bus_, options);
    ROOMCAL_TRY(dispatcher_.add(*standstill_));
  }
  if (all.servo.node != 0) {
    ROOMCAL_TRY(add_servo(all.servo));
    servo_->power_on();
  }
  return ok_status();
}

// It turns while a sweep is wanted, and rests otherwise.
void CanSide::turn_table() {
  servo_->poll();
  hand_on_angles();
  const bool faulted = servo_->step() == drivers::cia402::ServoStep::kFaulted;
  if (faulted && !told_servo_fault_) log_.note("servo", servo_->reason().view());
  told_servo_fault_ = faulted;
  if (tray_ == nullptr) return;
  if (!tray_->wants_turn()) return servo_->stop();
  if (faulted) return servo_->power_on();  // somebody waits for it: another try
  if (servo_->ready()) {
    if (const Status turns = servo_->turn(servo_rate_radps_); !turns.ok()) log_.note("servo", turns.detail());
  }
  if (servo_->at_speed()) tray_->begin_turn();
}

void CanSide::hand_on_angles() {
  for (drivers::cia402::ServoPosition position; servo_->next_position(position);) {
    const int64_t at_ns = bus_clock_.to_monotonic(position.on_bus, 0, clocks_.now_ns(), clocks_).exposed_ns;
    if (tray_ != nullptr) tray_->add_angle(at_ns, position.angle_rad);
  }
}

void CanSide::poll() {
  if (!station_) return;
  dispatcher_.poll();
  if (servo_) turn_table();
  if (standstill_) {
    still_ = standstill_->look(clocks_.now_ns());
    stillness_.tell(still_);
  }
  if (trigger_.wanted()) trigger_.done(station_->fire().ok());
  station_->poll();
  if (bus_.state() != told_state_) {
    told_state_ = bus_.state();
    log_.note("can", to_string(told_state_));
  }
}

void CanSide::set_status(const CanStatus& status) {
  if (!station_) return;
  drivers::CalStatus told;
  told.state = state_of(status);
  told.step = step_of(status.moment.state);
  told.progress_percent = status.moment.percent;
  told.reason = reason_of(status);
  told.stationary = status.still;
  told.store = store_of(status);
  station_->set_status(told);
}

void CanSide::announce(const press::Report& report, std::size_t done, std::size_t wanted, double rms_px,
                       uint64_t generation) {
  if (!station_) return;
  drivers::CalResult result;
  result.aborted = report.result == press::Result::kAborted;
  switch (report.result) {
    case press::Result::kPass:
      result.verdict = Verdict::kPass;
      break;
    case press::Result::kPassAdvise:
      result.verdict = Verdict::kPassAdvise;
      break;
    case press::Result::kFailRetry:
      result.verdict = Verdict::kFailRetry;
      break;
    default:
      result.verdict = Verdict::kFailService;
  }
  result.verify_only = report.kind != press::Kind::kCalibrate;
  result.sensors_done = done;
  result.sensors_wanted = wanted;
  result.rms_px = rms_px;
  result.generation = generation;
  station_->announce(result);
}

CanWish CanSide::next_wish() {
  drivers::CalCommand command;
  if (!station_ || !station_->next_command(command)) return CanWish::kNone;
  switch (command.command) {
    case drivers::dbc::cal_cmd::Command::kVerify:
      return CanWish::kVerify;
    case drivers::dbc::cal_cmd::Command::kCalibrate:
      return CanWish::kCalibrate;
    case drivers::dbc::cal_cmd::Command::kAbort:
      return CanWish::kAbort;
    case drivers::dbc::cal_cmd::Command::kNone:
      break;
  }
  return CanWish::kNone;
}

void CanSide::answer(Status status) {
  if (!station_) return;
  station_->answer(status.ok()                                 ? cal_status::CommandAnswer::kTaken
                   : status.code() == StatusCode::kUnavailable ? cal_status::CommandAnswer::kBusy
                                                               : cal_status::CommandAnswer::kNotPermitted);
}

}  // namespace roomcal::board
