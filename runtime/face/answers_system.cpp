#include <charconv>

#include "runtime/face/answers.h"

namespace roomcal::face {

using console::Reply;

namespace {

constexpr std::size_t kUsualLines = 20;

void tell_clock(std::string_view name, int64_t ns, int64_t monotonic_ns, Reply& reply) {
  if (ns == 0) return;
  reply.open(name);
  reply.number("s", static_cast<double>(ns) * 1e-9, 6, "s");
  reply.number("ahead_of_monotonic_s", static_cast<double>(ns - monotonic_ns) * 1e-9, 6, "s");
  reply.close();
}

}  // namespace

Status Answers::started(Status status, std::string_view what, Reply& reply) {
  if (status.ok()) reply.text("started", what);
  return status;
}

Status Answers::calibrate(Arguments arguments, Reply& reply) {
  const std::string_view how = arguments.empty() ? std::string_view() : arguments[0].view();
  if (how == "abort") return desk_.abort();
  if (how == "dry-run") return started(desk_.start(press::Kind::kDryRun), "dry-run", reply);
  return started(desk_.start(press::Kind::kCalibrate), "calibrate", reply);
}

Status Answers::selftest(Arguments arguments, Reply& reply) {
  Reason detail;
  const std::string_view part = arguments.empty() ? "sensors" : arguments[0].view();
  ROOMCAL_TRY(desk_.selftest(part, detail));
  reply.text(part, detail.view());
  return ok_status();
}

Status Answers::mem(Reply& reply) {
  desk_.examine(vitals_);
  reply.integer("reserved_bytes", static_cast<int64_t>(vitals_.locked_bytes));
  reply.flag("locked", vitals_.locked);
  reply.open("arenas");
  for (const ArenaVitals& arena : vitals_.arenas) {
    reply.open(arena.name);
    reply.integer("capacity", static_cast<int64_t>(arena.capacity));
    reply.integer("used", static_cast<int64_t>(arena.used));
    reply.integer("peak", static_cast<int64_t>(arena.peak));
    reply.integer("refusals", static_cast<int64_t>(arena.refusals));
    reply.close();
  }
  reply.close();
  reply.open("threads");
  for (const ThreadVitals& thread : vitals_.threads) {
    reply.open(thread.name.view());
    reply.integer("stack_bytes", static_cast<int64_t>(thread.stack_bytes));
    reply.integer("stack_peak", static_cast<int64_t>(thread.stack_peak));
    reply.integer("minor_faults", static_cast<int64_t>(thread.minor_faults));
    reply.integer("major_faults", static_cast<int64_t>(thread.major_faults));
    reply.number("answered_ms_ago", static_cast<double>(vitals_.now_ns - thread.answered_ns) * 1e-6, 0, "ms");
    reply.close();
  }
  reply.close();
  return ok_status();
}

Status Answers::clock(Reply& reply) {
  desk_.examine(vitals_);
  const ClockVitals& c = vitals_.clocks;
  reply.number("up_s", static_cast<double>(vitals_.now_ns - vitals_.armed_ns) * 1e-9, 1, "s");
  tell_clock("monotonic", c.monotonic_ns, c.monotonic_ns, reply);
  tell_clock("realtime", c.realtime_ns, c.monotonic_ns, reply);
  tell_clock("boottime", c.boottime_ns, c.monotonic_ns, reply);
  tell_clock("tai", c.tai_ns, c.monotonic_ns, reply);
  for (const CameraVitals& camera : vitals_.cameras) {
    reply.open(camera.name.view());
    reply.text("clock", to_string(camera.clock));
    reply.number("uncertainty_ms", static_cast<double>(camera.uncertainty_ns) * 1e-6, 3, "ms");
    reply.integer("steps", camera.clock_steps);
    reply.close();
  }
  return ok_status();
}

Status Answers::log(Arguments arguments, Reply& reply) {
  std::size_t lines = kUsualLines;
  if (!arguments.empty()) {
    const std::string_view text = arguments[0].view();
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), lines);
    if (error != std::errc() || end != text.data() + text.size())
      return {StatusCode::kInvalidArgument, "log takes a number of lines"};
  }
  reply.open_list("lines");
  desk_.read_log(
      lines, [](void* context, std::string_view line) { static_cast<Reply*>(context)->text({}, line); }, &reply);
  reply.close_list();
  return ok_status();
}

Status Answers::reboot(Reply& reply) {
  ROOMCAL_TRY(desk_.reboot());
  reply.text("reboot", "in a second");
  return ok_status();
}

}  // namespace roomcal::face
