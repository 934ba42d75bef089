#include "runtime/export/formats.h"
#include "runtime/export/frames.h"

namespace roomcal::exports {

namespace {

// Autoware's camera_link and LiDAR frames are bodies: x forward, y left, z up.
void write_child(const store::SensorRecord& sensor, const SE3& T_kit_rig, TextWriter& out) {
  const SE3 T_kit_child = T_kit_rig * sensor.T_rig_sensor * T_sensor_body(sensor);
  const Vec3 rpy = roll_pitch_yaw(T_kit_child.R);
  out.text("  \"").text(sensor.name.view());
  out.text(sensor.kind == store::SensorKind::kCamera ? "/camera_link\":" : "_base_link\":");
  out.text("\n    x: ").number(T_kit_child.t.x()).text("\n    y: ").number(T_kit_child.t.y());
  out.text("\n    z: ").number(T_kit_child.t.z()).text("\n    roll: ").number(rpy.x());
  out.text("\n    pitch: ").number(rpy.y()).text("\n    yaw: ").number(rpy.z()).text("\n");
}

}  // namespace

void write_autoware(const store::Record& record, TextWriter& out) {
  const store::SensorRecord& reference = record.sensors[record.reference];
  const SE3 T_kit_rig = T_sensor_body(reference).inverse();
  out.text("# ");
  write_origin(record, out);
  out.text("\n# sensor_kit_base_link: origin of ")
      .text(reference.name.view())
      .text(", x forward, y left, z up. Metres, radians.\n");
  const WorkedPoint point = worked_point(record, false);
  out.text("# worked point: (");
  write_triple(T_sensor_body(*point.sensor).inverse() * point.p_sensor, out);
  out.text(") in ").text(point.sensor->name.view()).text(" is (");
  write_triple(T_kit_rig * point.p_rig, out);
  out.text(") in sensor_kit_base_link\nsensor_kit_base_link:\n");
  for (const store::SensorRecord& sensor : record.sensors) write_child(sensor, T_kit_rig, out);
}

}  // namespace roomcal::exports
