#include "board/common/supervisor.h"

#include <algorithm>
#include <csignal>
#include <cstdio>

#include "board/common/bench.h"
#include "drivers/os/wait.h"
#include "runtime/base/reason.h"

namespace roomcal::board {

namespace {

constexpr int64_t kRound_ns = 10'000'000;
constexpr int64_t kProgress_ns = 200'000'000;   // a person reads no faster
constexpr int64_t kSilence_ns = 8'000'000'000;  // longer than any step of a press on a slow board
constexpr int64_t kOperateHold_ns = 1'000'000'000, kServiceHold_ns = 10'000'000'000;
constexpr int64_t kWell_ns = 60'000'000'000;
constexpr std::size_t kBytesARound = 256;  // 115200 baud brings 115 in that time; a flood waits

volatile std::sig_atomic_t end_wanted = 0;
void want_end(int /*signal*/) { end_wanted = 1; }

}  // namespace

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = want_end;
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGINT, &action, nullptr);
  action.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &action, nullptr);
  ::sigaction(SIGXFSZ, &action, nullptr);
}

Supervisor::Supervisor(const Options& options)
    : options_(options),
      log_(clocks_, options.console != "-"),
      bus_(can_kernel_, clocks_),
      can_(bus_, clocks_, log_),
      machine_({.board = options.board, .folder = {options.folder}, .starve_bytes = options.starve_bytes}, clocks_,
               log_, can_),
      panel_(files_, clocks_, log_),
      imu_stillness_(clocks_),
      starts_(state_file(), boot_id()),
      console_arena_(console_memory_) {}

std::string Supervisor::state_file() const {
  return (options_.state_folder.empty() ? options_.folder : options_.state_folder) + "/starts";
}

int Supervisor::print_memory_plan() {
  const Status planned = machine_.plan(trouble_);
  const BoardPlan& plan = machine_.board_plan();
  for (const PlanItem& item : plan.items)
    std::printf("%-28.*s %12zu\n", static_cast<int>(item.what.view().size()), item.what.view().data(), item.bytes);
  std::printf("%-28s %12zu of %zu\n", "total", plan.total_bytes(), plan.limit_bytes);
  if (planned.ok()) return 0;
  std::fprintf(stderr, "roomcald: %.*s\n", static_cast<int>(trouble_.view().size()), trouble_.view().data());
  return 1;
}

int Supervisor::check() {
  Status armed = machine_.plan(trouble_);
  if (armed.ok()) armed = machine_.arm(trouble_);
  if (armed.ok()) return 0;
  std::fprintf(stderr, "roomcald: %.*s\n", static_cast<int>(trouble_.view().size()), trouble_.view().data());
  return 1;
}

int Supervisor::bench() {
  if (const int armed = check(); armed != 0) return armed;
  if (machine_.profile() != nullptr) open_can(machine_.profile()->wiring);
  return run_bench(machine_, options_.bench_runs, [this] {
    can_.poll();
    clocks_.sleep_until(clocks_.now_ns() + kRound_ns);
  });
}

// The face first: whatever goes wrong afterwards can then be seen and asked for.
void Supervisor::open_face() {
  const profile::Profile* profile = machine_.profile();
  const bool own = !options_.console.empty();
  const Folder folder{options_.folder};
  const std::string path = own ? options_.console
                           : profile != nullptr && !profile->wiring.console.path.empty()
                               ? folder.below(profile->wiring.console.path.view())
                               : std::string();
  panel_.open_console(path, profile != nullptr ? profile->wiring.console.baud : 115'200);
  if (profile != nullptr) panel_.open(profile->wiring, folder);
  if (profile == nullptr || safe_mode_) return;
  open_can(profile->wiring);
  open_imu(profile->wiring.imu);
}

void Supervisor::open_imu(const profile::ImuWiring& wiring) {
  if (wiring.path.empty()) return;
  drivers::ImuOptions options;
  options.folder = std::string_view(Folder{options_.folder}.below(wiring.path.view()));
  imu_.emplace(options, files_);
  if (const Status started = imu_->start(); !started.ok()) log_.note("imu", started.detail());
  machine_.watch_motion(imu_stillness_);
}

void Supervisor::open_can(const profile::Wiring& wiring) {
  if (wiring.can.interface.empty()) return;
  Status opened = can_.start(wiring, static_cast<uint32_t>(clocks_.read(ClockId::kRealtime).ns));
  can_interface_ = wiring.can.interface.view();
  if (opened.ok()) opened = bus_.start({can_interface_.c_str(), can_.ids()});  // goes on looking for it
  if (!opened.ok()) log_.note("can", opened.detail());
}

void Supervisor::make_answers() {
  answers_.emplace(*this, face::Known{kFirmware, options_.board->name, machine_.profile(), machine_.map(),
                                      machine_.store(), machine_.press()});
  if (const Status opened = console_.open(console_arena_, *answers_); !opened.ok())
    log_.note("console", opened.detail());
  // Who started us by hand is at the device.
  if (options_.console == "-") console_.grant(console::Rights::kService, clocks_.now_ns());
}

int Supervisor::run() {
  begin_ns_ = clocks_.now_ns();
  log_.note("roomcald", kFirmware);
  safe_mode_ = starts_.begin() >= StartCounter::kTooMany;
  Status armed = machine_.plan(trouble_);
  open_face();
  if (safe_mode_) {
    trouble_ = "safe mode: the last three starts did not end well: see `log`, mend it, then `reboot`";
  } else if (armed.ok()) {
    armed = machine_.arm(trouble_);
    if (!armed.ok()) machine_.disarm();
  }
  if (!trouble_.empty()) log_.note("roomcald", trouble_.view());
  make_answers();
  if (machine_.armed()) log_.note("roomcald", "armed");
  panel_.service().ready();
  while (end_wanted == 0 && (reboot_at_ns_ == 0 || clocks_.now_ns() < reboot_at_ns_)) {
    const int64_t now_ns = clocks_.now_ns();
    round(now_ns);
    wait(now_ns + kRound_ns);
  }
  starts_.well();
  machine_.disarm();
  panel_.close();
  return reboot_at_ns_ != 0 ? 3 : 0;
}

void Supervisor::wait(int64_t deadline_ns) {
  std::array<int, 2> fds{-1, -1};
  if (panel_.console() != nullptr) fds[0] = panel_.console()->fd();
  if (panel_.button() != nullptr) fds[1] = panel_.button()->fd();
  static_cast<void>(drivers::wait_readable(fds, deadline_ns));
}

void Supervisor::round(int64_t now_ns) {
  serve_button(now_ns);
  serve_console(now_ns);
  serve_can(now_ns);
  serve_imu(now_ns);
  tell_progress(now_ns);
  if (machine_.armed() && machine_.press_thread().presses() != told_presses_) tell_result();
  if (machine_.armed() && machine_.press_thread().looks() != told_looks_) tell_sight();
  serve_light(now_ns);
  serve_watchdogs(now_ns);
  if (now_ns - begin_ns_ > kWell_ns && !safe_mode_) starts_.well();
}

void Supervisor::serve_button(int64_t now_ns) {
  if (panel_.button() == nullptr) return;
  const bool was_stuck = button_.stuck();
  const bool running = machine_.armed() && machine_.press_thread().busy();
  for (ports::ButtonEdge edge; panel_.button()->next(edge);) act(button_.on_edge(edge, running));
  act(button_.tick(now_ns));
  if (button_.stuck() && !was_stuck) log_.note("button", "held for a minute: stuck, or wired the wrong way round");
  raise_rights(now_ns);
}

// Whoever holds the button is at the device: told once for each level of a hold.
void Supervisor::raise_rights(int64_t now_ns) {
  console::Rights shown = console::Rights::kObserve;
  if (button_.held_for(kOperateHold_ns, now_ns) && !button_.stuck()) shown = console::Rights::kOperate;
  if (button_.held_for(kServiceHold_ns, now_ns) && !button_.stuck()) shown = console::Rights::kService;
  if (shown > presence_) console_.grant(shown, now_ns);
  presence_ = shown;
}

void Supervisor::act(face::Gesture gesture) {
  if (gesture == face::Gesture::kNone) return;
  log_.note("button", to_string(gesture));
  Status done;
  switch (gesture) {
    case face::Gesture::kAbort:
      done = abort();
      break;
    case face::Gesture::kVerify:
      done = start(press::Kind::kVerify);
      break;
    case face::Gesture::kCalibrate:
      done = start(press::Kind::kCalibrate);
      break;
    case face::Gesture::kRestore:
      restore_factory();
      break;
    case face::Gesture::kOffer:
    case face::Gesture::kNone:
      break;
  }
  if (!done.ok()) log_.note("button", done.detail());
}

void Supervisor::restore_factory() {
  if (machine_.store() == nullptr || machine_.press_thread().busy()) return;
  const Status restored = machine_.store()->restore_factory(unix_s());
  log_.note("store", restored.ok() ? "factory record restored" : restored.detail());
}

void Supervisor::serve_console(int64_t now_ns) {
  drivers::SerialPort* line = panel_.console();
  if (line == nullptr) return;
  std::array<char, kBytesARound> bytes{};
  const std::size_t count = line->read_some(bytes);
  if (count > 0) console_.feed(std::span<const char>(bytes).first(count), now_ns);
  console_.tick(now_ns);
  console_.pump(*line);
}

void Supervisor::serve_imu(int64_t now_ns) {
  if (!imu_) return;
  imu_->sample(now_ns);
  imu_stillness_.tell(imu_->look(now_ns));
}

/// Of all sensors of motion; still where there are none.
ports::Stillness Supervisor::stillness() {
  if (can_.has_standstill() && !can_.still_now().still) return can_.still_now();
  return imu_ ? imu_->look(clocks_.now_ns()) : ports::Stillness{true, {}};
}

void Supervisor::serve_can(int64_t /*now_ns*/) {
  if (!can_.started()) return;
  can_.poll();
  CanStatus status;
  status.armed = machine_.armed();
  status.moment = moment();
  status.still = stillness().still;
  if (machine_.armed()) status.kind = machine_.press_thread().kind();
  if (machine_.armed() && !machine_.press_thread().busy()) {
    status.result = machine_.press()->report().result;
    status.trouble = machine_.press()->report().trouble;
    status.store = machine_.store()->state();
    status.store_damaged = !machine_.store()->diagnosis().empty();
  }
  can_.set_status(status);
  switch (can_.next_wish()) {
    case CanWish::kNone:
      break;
    case CanWish::kVerify:
      can_.answer(start(press::Kind::kVerify));
      break;
    case CanWish::kCalibrate:
      can_.answer(start(press::Kind::kCalibrate));
      break;
    case CanWish::kAbort:
      can_.answer(abort());
      break;
  }
}

press::Moment Supervisor::moment() { return machine_.press() != nullptr ? machine_.press()->now() : press::Moment(); }

void Supervisor::tell_progress(int64_t now_ns) {
  const press::Moment now = moment();
  if (now.state == press::State::kIdle || now_ns - told_ns_ < kProgress_ns) return;
  if (now.state == told_moment_.state && now.percent == told_moment_.percent) return;
  told_moment_ = now;
  told_ns_ = now_ns;
  console_.event("progress", [&](console::Reply& reply) {
    reply.text("state", to_string(now.state));
    reply.integer("percent", now.percent);
  });
  panel_.service().status(to_string(now.state));
}

void Supervisor::tell_result() {
  told_presses_ = machine_.press_thread().presses();
  told_moment_ = {};
  const press::Report& report = machine_.press()->report();
  const store::Record* record = machine_.store()->current();
  const uint64_t generation = record != nullptr ? record->generation : 0;
  log_.note("session", make_reason("%s: %s", to_string(report.kind), to_string(report.result)).view());
  for (const Reason& reason : report.reasons) log_.note("session", reason.view());
  if (report.stored) {
    const Reason stored =
        make_reason("generation %llu is in force", static_cast<unsigned long long>(report.generation));
    log_.note("store", stored.view());
  }
  console_.event("result", [&](console::Reply& reply) {
    reply.text("kind", to_string(report.kind));
    reply.text("result", to_string(report.result));
    if (report.trouble != press::Trouble::kNone) reply.text("trouble_class", to_string(report.trouble));
    for (const Reason& reason : report.reasons) reply.text("reason", reason.view());
    reply.flag("stored", report.stored);
    if (report.stored) reply.integer("generation", static_cast<int64_t>(report.generation));
    reply.number("total_ms", static_cast<double>(report.total_ns) * 1e-6, 0, "ms");
  });
  std::size_t done = 0;
  double rms_px = 0;
  if (machine_.press()->has_outcome()) {
    const calib::Outcome& outcome = machine_.press()->outcome();
    for (const calib::LocatedSensor& sensor : located_sensors(outcome)) done += sensor.in_rig ? 1 : 0;
    for (const calib::CameraOutcome& camera : outcome.cameras) rms_px = std::max(rms_px, camera.rms_px);
  }
  can_.announce(report, done, machine_.device().cameras.size() + machine_.device().lidars.size(), rms_px, generation);
  panel_.service().status(to_string(report.result));
  machine_.advance_replay();
}

void Supervisor::serve_light(int64_t now_ns) {
  if (panel_.light() == nullptr) return;
  if (now_ns < lamp_test_until_ns_) return panel_.light()->set(true);
  face::LightInput input;
  input.safe_mode = safe_mode_ || !machine_.armed();
  input.hold = button_.hold(now_ns);
  input.offered = button_.offered();
  input.state = moment().state;
  if (machine_.armed() && !machine_.press_thread().busy()) {
    input.result = machine_.press()->report().result;
    input.trouble = machine_.press()->report().trouble;
    input.store = machine_.store()->state();
  }
  input.sensor_faulted = sensor_faulted();
  // A lamp that blinks says that all threads live.
  panel_.light()->set(threads_answer(now_ns) && light_.lit(input, now_ns));
}

bool Supervisor::sensor_faulted() {
  const int64_t now_ns = clocks_.now_ns();
  if (!machine_.armed() || now_ns - faulted_looked_ns_ < 1'000'000'000) return faulted_;
  faulted_looked_ns_ = now_ns;
  examine(vitals_);
  const auto bad = [&](const auto& sensor) { return !complaint(sensor, now_ns).empty(); };
  faulted_ = std::any_of(vitals_.cameras.begin(), vitals_.cameras.end(), bad) ||
             std::any_of(vitals_.lidars.begin(), vitals_.lidars.end(), bad);
  return faulted_;
}

bool Supervisor::threads_answer(int64_t now_ns) const {
  return !blocked_ && machine_.longest_silence_ns(now_ns) < kSilence_ns;
}

void Supervisor::serve_watchdogs(int64_t now_ns) {
  const bool answer = threads_answer(now_ns);
  if (answer) panel_.feed();
  if (answer == !hangs_ || blocked_) return;
  hangs_ = !answer;
  log_.note("roomcald",
            hangs_ ? "a thread does not answer: the watchdogs are no longer fed" : "all threads answer again");
  starts_.hangs(hangs_);
}

}  // namespace roomcal::board
