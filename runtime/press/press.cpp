#include "runtime/press/press.h"

#include <algorithm>

#include "runtime/base/reason.h"
#include "runtime/calib/compare_installed.h"
#include "runtime/press/trouble.h"

namespace roomcal::press {

namespace {

// Where each step begins in a bar of a hundred; the grab takes most of the time.
constexpr int kGrabFrom = 5, kComputeFrom = 60, kWriteFrom = 90, kCheckFrom = 97;

State state_of(calib::Stage stage) {
  switch (stage) {
    case calib::Stage::kDetect:
      return State::kDetect;
    case calib::Stage::kLocate:
      return State::kLocate;
    case calib::Stage::kLocateLidars:
      return State::kLocateLidars;
    case calib::Stage::kRefine:
      return State::kSolve;
    case calib::Stage::kJudge:
    case calib::Stage::kCount:
      break;
  }
  return State::kJudge;
}

/// Seconds of Unix time; 0 where the host's clock was never set.
int64_t unix_s(const ports::SystemClocks& clocks) {
  constexpr int64_t kNeverSet_s = 1'600'000'000;  // before this program was written
  const int64_t now_s = clocks.read(ClockId::kRealtime).ns / 1'000'000'000;
  return now_s > kNeverSet_s ? now_s : 0;
}

}  // namespace

Moment Press::now() const {
  const uint16_t moment = moment_.load(std::memory_order_acquire);
  return {static_cast<State>(moment >> 8), static_cast<uint8_t>(moment & 0xFF)};
}

void Press::enter(State state, int percent) {
  const int so_far = state == State::kIdle ? 0 : now().percent;
  const int shown = state == State::kIdle ? 0 : std::clamp(percent, so_far, 100);
  moment_.store(static_cast<uint16_t>(static_cast<unsigned>(state) << 8 | static_cast<unsigned>(shown)),
                std::memory_order_release);
}

void Press::add(const Reason& reason) {
  // Beyond a screenful nobody reads; the first ones name the cause.
  static_cast<void>(report_.reasons.push_back(reason));
}

void Press::begin() {
  abort_ = false;
  enter(State::kWaitStill, 0);
}

void Press::run(Kind kind) {
  const int64_t begin_ns = parts_.clocks.now_ns();
  report_ = Report();
  report_.kind = kind;
  has_outcome_ = false;
  Status status = grab();
  if (status.ok()) status = measure();
  if (status.ok() && kind == Kind::kCalibrate && may_write(outcome_.verdict)) status = keep();
  parts_.grabber.release(shot_);
  conclude(status);
  report_.total_ns = parts_.clocks.now_ns() - begin_ns;
  enter(State::kIdle, 0);
}

Status Press::grab() {
  const int64_t begin_ns = parts_.clocks.now_ns();
  const Status grabbed = parts_.grabber.grab(*this, shot_);
  report_.grab_ns = parts_.clocks.now_ns() - begin_ns;
  report_.measured_unix_s = unix_s(parts_.clocks);
  if (parts_.thermometer != nullptr) report_.temperature_c = parts_.thermometer->read_c();
  if (!grabbed.ok()) {
    report_.trouble = grabbed.code() == StatusCode::kUnavailable ? Trouble::kMotion
                      : grabbed.code() == StatusCode::kTooFew    ? Trouble::kImages
                                                                 : Trouble::kDevice;
    if (!parts_.grabber.reason().empty()) add(parts_.grabber.reason());
    return grabbed;
  }
  report_.spread_ns = shot_.spread_ns;
  report_.spread_uncertainty_ns = shot_.uncertainty_ns;
  report_.tries = shot_.tries;
  return ok_status();
}

Status Press::measure() {
  const int64_t begin_ns = parts_.clocks.now_ns();
  parts_.session.installed = parts_.store.current();
  shot_memory_.emplace(parts_.arenas.step);
  has_outcome_ = true;
  const calib::Shot shot{shot_.images.span(), shot_.sweeps.span()};
  const Status measured = calib::calibrate(parts_.session, shot, parts_.clocks, parts_.arenas, outcome_, this);
  report_.compute_ns = parts_.clocks.now_ns() - begin_ns;
  for (const Reason& reason : outcome_.reasons) add(reason);
  for (const Reason& note : shot_.notes) add(note);
  report_.trouble = may_write(outcome_.verdict) ? Trouble::kNone : trouble_of(outcome_);
  return measured;
}

Status Press::keep() {
  const int64_t begin_ns = parts_.clocks.now_ns();
  enter(State::kWrite, kWriteFrom);
  calib::RecordContext context;
  context.map_id = parts_.session.map.map_id();
  context.map_hash = parts_.session.map.content_crc32c();
  context.firmware_id = parts_.firmware_id;
  context.device_serial = parts_.device_serial;
  context.measured_unix_s = report_.measured_unix_s;
  context.temperature_c = report_.temperature_c;
  context.trigger = parts_.trigger;
  Status kept = calib::to_record(outcome_, parts_.session.device, context, record_);
  if (kept.ok()) kept = parts_.store.commit(record_, unix_s(parts_.clocks));
  if (kept.ok()) {
    enter(State::kCheck, kCheckFrom);
    kept = check();
  }
  report_.write_ns = parts_.clocks.now_ns() - begin_ns;
  if (!kept.ok()) {
    report_.trouble = Trouble::kStore;
    add(make_reason("store: %s", kept.detail()));
    return kept;
  }
  report_.stored = true;
  report_.generation = parts_.store.current()->generation;
  return ok_status();
}

// What consumers will read is compared with what was just measured: it must be the same extrinsics, sensor by sensor.
Status Press::check() {
  const calib::InstalledCheck before = outcome_.installed;
  parts_.store.load();
  parts_.session.installed = parts_.store.current();
  bool same = parts_.session.installed != nullptr;
  if (same) {
    calib::compare_installed(parts_.session, outcome_);
    for (const calib::SensorChange& change : outcome_.installed.sensors)
      same = same && (!change.comparable || change.delta.norm() < 1e-9);
  }
  outcome_.installed = before;
  if (same) return ok_status();
  const Status undone = parts_.store.undo(unix_s(parts_.clocks));
  return {StatusCode::kCorrupt, undone.ok()
                                    ? "what was read back is not what was measured: the record before is in force again"
                                    : "what was read back is not what was measured, and it cannot be undone"};
}

void Press::conclude(Status status) {
  if (status.code() == StatusCode::kCancelled) {
    report_.result = Result::kAborted;
    report_.trouble = Trouble::kNone;
    report_.reasons.clear();
    add("stopped by the operator: nothing was stored");
  } else if (report_.trouble == Trouble::kStore) {
    report_.result = Result::kFailService;
  } else if (!has_outcome_) {
    report_.result = report_.trouble == Trouble::kDevice ? Result::kFailService : Result::kFailRetry;
  } else if (!status.ok()) {
    report_.result = Result::kFailService;
    report_.trouble = Trouble::kDevice;
    add(make_reason("session: %s: %s", to_string(status.code()), status.detail()));
  } else {
    report_.result = to_result(outcome_.verdict);
  }
}

bool Press::waiting(grab::GrabStep step, const Reason& /*why*/) {
  switch (step) {
    case grab::GrabStep::kStillness:
      enter(State::kWaitStill, 0);
      break;
    case grab::GrabStep::kImages:
      enter(State::kGrab, kGrabFrom);
      break;
    case grab::GrabStep::kSweeps:
      enter(State::kGrab, (kGrabFrom + kComputeFrom) / 2);
      break;
  }
  return go_on();
}

bool Press::on_step(const calib::Progress& progress) {
  const auto share = static_cast<double>(progress.done) / static_cast<double>(std::max<std::size_t>(1, progress.total));
  enter(state_of(progress.stage), kComputeFrom + static_cast<int>(share * (kWriteFrom - kComputeFrom)));
  return go_on();
}

bool Press::go_on() {
  if (parts_.alive_ns != nullptr) parts_.alive_ns->store(parts_.clocks.now_ns(), std::memory_order_relaxed);
  return !abort_.load(std::memory_order_relaxed);
}

}  // namespace roomcal::press
