#include "runtime/export/frames.h"

#include <cmath>

namespace roomcal::exports {

SE3 T_sensor_body(const store::SensorRecord& sensor) {
  SE3 T;
  if (sensor.kind == store::SensorKind::kCamera)
    T.R << 0, -1, 0,  //
        0, 0, -1,     //
        1, 0, 0;
  else if (sensor.model.view().starts_with("vlp"))
    T.R << 0, -1, 0,  //
        1, 0, 0,      //
        0, 0, 1;
  return T;
}

Vec3 roll_pitch_yaw(const Mat33& R) {
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  const double c = std::cos(yaw), s = std::sin(yaw);
  // Roll of what is left after undoing the yaw: consistent with it even where only their sum is determined.
  const double pitch = std::atan2(-R(2, 0), c * R(0, 0) + s * R(1, 0));
  const double roll = std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1));
  return {roll, pitch, yaw};
}

WorkedPoint worked_point(const store::Record& record, bool cameras_only) {
  const store::SensorRecord* chosen = nullptr;
  for (std::size_t i = 0; i < record.sensors.size(); ++i) {
    const store::SensorRecord& sensor = record.sensors[i];
    if (cameras_only && sensor.kind != store::SensorKind::kCamera) continue;
    if (chosen == nullptr || i != record.reference) chosen = &sensor;
  }
  const Vec3 p_sensor(0.25, -0.5, 2.0);
  if (chosen == nullptr) return {};
  return {chosen, p_sensor, chosen->T_rig_sensor * p_sensor};
}

void write_triple(const Vec3& v, TextWriter& out, std::string_view separator) {
  out.number(v.x()).text(separator).number(v.y()).text(separator).number(v.z());
}

void write_origin(const store::Record& record, TextWriter& out) {
  out.text("roomcal record, generation ").unsigned_integer(record.generation);
  out.text(", measured at ")
      .integer(record.measured_unix_s)
      .text(" s of Unix time, verdict ")
      .text(to_string(record.verdict));
  out.text(", map ").hex(record.map_hash);
}

}  // namespace roomcal::exports
