// What the supervisor does for those who ask: button, console, CAN.
#include "board/common/supervisor.h"
#include "runtime/base/reason.h"

namespace roomcal::board {

namespace {

constexpr int64_t kLampTest_ns = 2'000'000'000;
constexpr int64_t kReboot_ns = 1'000'000'000;  // the answer is to get out first

}  // namespace

Status Supervisor::start(press::Kind kind) {
  if (!machine_.armed()) return {StatusCode::kUnavailable, "the device is not armed: see `status`"};
  if (!machine_.press_thread().start(kind))
    return {StatusCode::kUnavailable, "something runs already: wait for its result, or abort it"};
  return ok_status();
}

Status Supervisor::abort() {
  if (!machine_.armed() || !machine_.press_thread().busy()) return {StatusCode::kNotFound, "nothing runs"};
  machine_.press()->abort();
  return ok_status();
}

Status Supervisor::look(std::string_view sensor) {
  if (!machine_.armed()) return {StatusCode::kUnavailable, "the device is not armed: see `status`"};
  const calib::Device& device = machine_.device();
  std::size_t number = 0;
  const auto found = [&](const auto& candidates) {
    for (const auto& candidate : candidates) {
      if (sensor.empty() || candidate.name.view() == sensor) return true;
      ++number;
    }
    return false;
  };
  if (!found(device.cameras) && !found(device.lidars))
    return {StatusCode::kNotFound, "no sensor has that name: see `sensors`"};
  if (!machine_.press_thread().start_look(number))
    return {StatusCode::kUnavailable, "something runs already: wait for its result, or abort it"};
  return ok_status();
}

void Supervisor::tell_sight() {
  told_looks_ = machine_.press_thread().looks();
  const press::Sight& sight = machine_.look().sight();
  console_.event("grab", [&](console::Reply& reply) {
    reply.text("sensor", sight.sensor.view());
    reply.flag("came", sight.came);
    if (!sight.complaint.empty()) reply.text("complaint", sight.complaint.view());
    if (!sight.came) return;
    if (!sight.camera) {
      reply.integer("points", static_cast<int64_t>(sight.points));
      reply.number("horizon", sight.horizon, 2);
      reply.number("nearest_m", sight.nearest_m, 2, "m");
      reply.number("farthest_m", sight.farthest_m, 2, "m");
      return;
    }
    reply.integer("level_low", sight.low);
    reply.integer("level_mean", sight.mean);
    reply.integer("level_high", sight.high);
    reply.number("saturated", sight.saturated, 3);
    reply.integer("rings", static_cast<int64_t>(sight.rings));
    reply.integer("usable_rings", static_cast<int64_t>(sight.usable_rings));
    reply.number("detect_ms", sight.detect_ms, 1, "ms");
  });
}

Status Supervisor::selftest(std::string_view part, Reason& detail) {
  if (part == "led") {
    if (panel_.light() == nullptr) return {StatusCode::kNotFound, "this device has no lamp"};
    lamp_test_until_ns_ = clocks_.now_ns() + kLampTest_ns;
    detail = "lit for two seconds";
  } else if (part == "button") {
    if (panel_.button() == nullptr) return {StatusCode::kNotFound, "this device has no button"};
    detail = panel_.button()->fd() < 0                           ? "its device is not there"
             : button_.hold(clocks_.now_ns()) != face::Hold::kUp ? "down"
                                                                 : "up";
  } else if (part == "sensors") {
    detail = sensor_faulted() ? "a sensor is down: see `health`" : "all sensors deliver";
  } else if (part == "store") {
    if (machine_.store() == nullptr) return {StatusCode::kNotFound, "the store could not be opened"};
    if (machine_.armed() && machine_.press_thread().busy()) return {StatusCode::kUnavailable, "a press runs"};
    machine_.store()->load();
    const Reason diagnosis = machine_.store()->diagnosis();
    detail = diagnosis.empty() ? Reason("every slot reads back well") : diagnosis;
  } else if (part == "map") {
    if (machine_.map() == nullptr) return {StatusCode::kNotFound, "no map could be read"};
    detail =
        machine_.map_intact() ? "sums, structure and content hold" : "it has changed in memory: restart the device";
  } else if (part == "watchdog") {
    if (!panel_.has_watchdog() && !panel_.service().active())
      return {StatusCode::kNotFound, "nobody watches this device"};
    if (console_.rights() != console::Rights::kService) {
      detail = make_reason("runs, %d s; with service rights this stops feeding it", panel_.watchdog_timeout_s());
      return ok_status();
    }
    blocked_ = true;
    detail = "no longer fed: the device restarts";
  } else {
    return {StatusCode::kNotFound, "no such part"};
  }
  return ok_status();
}

Status Supervisor::reboot() {
  log_.note("roomcald", "reboot asked for");
  reboot_at_ns_ = clocks_.now_ns() + kReboot_ns;
  return ok_status();
}

void Supervisor::examine(face::Vitals& vitals) {
  vitals = face::Vitals();
  vitals.now_ns = clocks_.now_ns();
  vitals.safe_mode = safe_mode_;
  vitals.trouble = trouble_;
  vitals.clocks = {vitals.now_ns, clocks_.read(ClockId::kRealtime).ns, clocks_.read(ClockId::kBoottime).ns,
                   clocks_.read(ClockId::kTai).ns};
  machine_.examine(vitals);
  vitals.has_can = can_.started();
  vitals.can = can_.bus().state();
  vitals.can_counters = can_.bus().counters();
  vitals.servo_trouble = can_.servo_trouble();
  vitals.has_stillness = can_.has_standstill() || imu_.has_value();
  vitals.stillness = stillness();
}

void Supervisor::read_log(std::size_t lines, void (*visit)(void* context, std::string_view line), void* context) {
  log_.read(lines, visit, context);
}

int64_t Supervisor::unix_s() const { return clocks_.read(ClockId::kRealtime).ns / 1'000'000'000; }

}  // namespace roomcal::board
