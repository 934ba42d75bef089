#include <cmath>

#include "runtime/base/reason.h"
#include "runtime/face/answers.h"

namespace roomcal::face {

using console::Reply;

namespace {

double to_ms(int64_t ns) { return static_cast<double>(ns) * 1e-6; }

void tell_reasons(std::span<const Reason> reasons, Reply& reply) {
  if (reasons.empty()) return;
  reply.open_list("reasons");
  for (const Reason& reason : reasons) reply.text({}, reason.view());
  reply.close_list();
}

void tell_sensor(const calib::LocatedSensor& sensor, Reply& reply) {
  reply.open({});
  reply.text("name", sensor.name.view());
  const Vec3& t = sensor.T_rig_sensor.t;
  const Vec3 rotation = so3_log(sensor.T_rig_sensor.R);
  const char* const axis[] = {"x", "y", "z"};
  const char* const turn[] = {"rx", "ry", "rz"};
  for (int i = 0; i < 3; ++i) reply.number(axis[i], t[i], 6, "m");
  for (int i = 0; i < 3; ++i) reply.number(turn[i], rad_to_deg(rotation[i]), 5, "deg");
  reply.number("sigma_m", std::sqrt(sensor.cov_rig_sensor.diagonal().head<3>().maxCoeff()), 7, "m");
  reply.number("sigma_deg", rad_to_deg(std::sqrt(sensor.cov_rig_sensor.diagonal().tail<3>().maxCoeff())), 6, "deg");
  reply.close();
}

void tell_change(const calib::InstalledCheck& installed, Reply& reply) {
  if (!installed.done) return;
  reply.open("installed");
  reply.flag("moved", installed.moved);
  if (installed.moved) reply.text("moved_sensor", installed.moved_sensor.view());
  reply.number("p_value", installed.p_value, 4);
  for (const calib::SensorChange& change : installed.sensors) {
    if (!change.comparable) continue;
    reply.open(change.name.view());
    reply.number("distance_mm", 1e3 * change.delta.head<3>().norm(), 3, "mm");
    reply.number("angle_deg", rad_to_deg(change.delta.tail<3>().norm()), 4, "deg");
    reply.number("p_value", change.p_value, 4);
    reply.close();
  }
  reply.close();
}

void tell_times(const press::Report& report, const calib::Outcome* outcome, Reply& reply) {
  reply.open("timing_ms");
  reply.number("grab", to_ms(report.grab_ns), 1);
  if (outcome != nullptr)
    for (std::size_t i = 0; i < outcome->stage_ns.size(); ++i)
      reply.number(to_string(static_cast<calib::Stage>(i)), to_ms(outcome->stage_ns[i]), 1);
  reply.number("compute", to_ms(report.compute_ns), 1);
  reply.number("write", to_ms(report.write_ns), 1);
  reply.number("total", to_ms(report.total_ns), 1);
  reply.close();
}

}  // namespace

Status Answers::version(Reply& reply) {
  reply.text("firmware", known_.firmware);
  reply.text("board", known_.board);
  if (known_.profile != nullptr) {
    reply.text("device", known_.profile->device.view());
    reply.text("serial", known_.profile->serial.view());
  }
  if (known_.map != nullptr) reply.text("map", known_.map->map_id());
  return ok_status();
}

Status Answers::status(Reply& reply) {
  desk_.examine(vitals_);
  if (vitals_.safe_mode) reply.text("mode", "SAFE");
  if (!vitals_.trouble.empty()) reply.text("trouble", vitals_.trouble.view());
  const press::Moment moment = known_.press != nullptr ? known_.press->now() : press::Moment();
  reply.text("state", to_string(moment.state));
  if (moment.state != press::State::kIdle) {
    reply.integer("percent", moment.percent);
    return ok_status();
  }
  if (known_.press != nullptr) {
    const press::Report& report = known_.press->report();
    reply.text("result", to_string(report.result));
    if (report.result == press::Result::kFailRetry || report.result == press::Result::kFailService)
      reply.text("trouble_class", to_string(report.trouble));
  }
  if (known_.store != nullptr) static_cast<void>(tell_in_force(reply));
  if (vitals_.has_stillness) reply.flag("still", vitals_.stillness.still);
  return ok_status();
}

Status Answers::health(Reply& reply) {
  desk_.examine(vitals_);
  std::size_t complaints = 0;
  reply.open_list("complaints");
  const auto tell = [&](const Reason& reason) {
    if (reason.empty()) return;
    ++complaints;
    reply.text({}, reason.view());
  };
  tell(vitals_.trouble);
  for (const CameraVitals& camera : vitals_.cameras) tell(complaint(camera, vitals_.now_ns));
  for (const LidarVitals& lidar : vitals_.lidars) tell(complaint(lidar, vitals_.now_ns));
  if (vitals_.has_can && vitals_.can != ports::CanState::kActive)
    tell(make_reason("can: %s: check wiring, bit rate and the other stations", to_string(vitals_.can)));
  tell(vitals_.trigger_trouble);
  tell(vitals_.servo_trouble);
  if (vitals_.has_stillness && !vitals_.stillness.still) tell(vitals_.stillness.why);
  if (!vitals_.locked && vitals_.locked_bytes > 0)
    tell("memory: it is not locked: raise LimitMEMLOCK in the service's unit");
  if (known_.store != nullptr && store_is_free().ok()) tell(known_.store->diagnosis());
  reply.close_list();
  reply.flag("well", complaints == 0);
  return ok_status();
}

Status Answers::map(Arguments arguments, Reply& reply) {
  if (known_.map == nullptr) return {StatusCode::kNotFound, "no map could be read: copy one to the device"};
  const map::RoomMap& room = *known_.map;
  reply.text("map_id", room.map_id());
  std::array<char, 8> digits{};
  TextWriter hash(digits);
  reply.text("hash", hash.hex(room.content_crc32c()).view());
  reply.text("provenance", room.provenance());
  reply.integer("created_unix_s", room.created_unix_s());
  reply.integer("markers", static_cast<int64_t>(room.marker_count()));
  reply.integer("planes", static_cast<int64_t>(room.plane_count()));
  reply.integer("triangles", static_cast<int64_t>(room.triangles().size()));
  // It was checked as a whole before it was armed, and is in memory that nobody writes to.
  if (!arguments.empty()) reply.text("verified", "sums, structure and content hold");
  return ok_status();
}

Status Answers::result(Reply& reply) {
  ROOMCAL_TRY(store_is_free());
  if (known_.press == nullptr || known_.press->report().result == press::Result::kNone)
    return {StatusCode::kNotFound, "nothing was measured since the start: press the button, or `verify`"};
  const press::Report& report = known_.press->report();
  const calib::Outcome* outcome = known_.press->has_outcome() ? &known_.press->outcome() : nullptr;
  reply.text("kind", to_string(report.kind));
  reply.text("result", to_string(report.result));
  if (report.trouble != press::Trouble::kNone) reply.text("trouble_class", to_string(report.trouble));
  tell_reasons(report.reasons.span(), reply);
  reply.flag("stored", report.stored);
  if (report.stored) reply.integer("generation", static_cast<int64_t>(report.generation));
  reply.integer("measured_unix_s", report.measured_unix_s);
  if (!std::isnan(report.temperature_c)) reply.number("temperature_c", report.temperature_c, 1, "degC");
  reply.number("spread_ms", to_ms(report.spread_ns), 3, "ms");
  reply.number("spread_uncertainty_ms", to_ms(report.spread_uncertainty_ns), 3, "ms");
  reply.integer("tries", static_cast<int64_t>(report.tries));
  if (outcome != nullptr) {
    reply.open_list("sensors");
    for (const calib::LocatedSensor& sensor : located_sensors(*outcome))
      if (sensor.in_rig) tell_sensor(sensor, reply);
    reply.close_list();
    tell_change(outcome->installed, reply);
  }
  tell_times(report, outcome, reply);
  return ok_status();
}

}  // namespace roomcal::face
