#include <Eigen/Geometry>

#include "runtime/export/formats.h"
#include "runtime/export/frames.h"

namespace roomcal::exports {

namespace {

// A double hyphen ends an XML comment, and a sensor's name may hold one.
void write_comment_word(std::string_view word, TextWriter& out) {
  char before = ' ';
  for (const char c : word) {
    const char safe = c == '-' && before == '-' ? '_' : c;
    out.character(safe);
    before = safe;
  }
}

// A camera's axes are ROS's optical ones; a LiDAR's are the sensor's own.
void write_frame(const store::SensorRecord& sensor, TextWriter& out) {
  out.text(sensor.name.view()).text(sensor.kind == store::SensorKind::kCamera ? "_optical_frame" : "_sensor_frame");
}

void write_worked_point(const store::Record& record, TextWriter& out) {
  const WorkedPoint point = worked_point(record, false);
  out.text("  <!-- worked point: (");
  write_triple(point.p_sensor, out);
  out.text(") in ");
  write_comment_word(point.sensor->name.view(), out);
  out.text(" is (");
  write_triple(point.p_rig, out);
  out.text(") in rig -->\n");
}

void write_joint(const store::SensorRecord& sensor, TextWriter& out) {
  out.text("  <link name=\"");
  write_frame(sensor, out);
  out.text("\"/>\n  <joint name=\"rig_to_")
      .text(sensor.name.view())
      .text("\" type=\"fixed\">\n    <parent link=\"rig\"/>\n");
  out.text("    <child link=\"");
  write_frame(sensor, out);
  out.text("\"/>\n    <origin xyz=\"");
  write_triple(sensor.T_rig_sensor.t, out, " ");
  out.text("\" rpy=\"");
  write_triple(roll_pitch_yaw(sensor.T_rig_sensor.R), out, " ");
  out.text("\"/>\n  </joint>\n");
}

void write_node(const store::SensorRecord& sensor, TextWriter& out) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(sensor.T_rig_sensor.R).normalized();
  out.text("  <node pkg=\"tf2_ros\" exec=\"static_transform_publisher\" name=\"tf_").text(sensor.name.view());
  out.text("\" args=\"--x ").number(sensor.T_rig_sensor.t.x()).text(" --y ").number(sensor.T_rig_sensor.t.y());
  out.text(" --z ").number(sensor.T_rig_sensor.t.z()).text(" --qx ").number(q.x()).text(" --qy ").number(q.y());
  out.text(" --qz ").number(q.z()).text(" --qw ").number(q.w()).text(" --frame-id rig --child-frame-id ");
  write_frame(sensor, out);
  out.text("\"/>\n");
}

void write_top(const store::Record& record, TextWriter& out) {
  out.text("<?xml version=\"1.0\"?>\n<!-- ");
  write_origin(record, out);
  out.text(". rig: axes of the reference sensor ");
  write_comment_word(record.sensors[record.reference].name.view(), out);
  out.text(". Metres, radians. Cameras: x right, y down, z forward; Velodyne: x right, y forward, z up. -->\n");
}

}  // namespace

void write_urdf(const store::Record& record, TextWriter& out) {
  write_top(record, out);
  out.text("<robot name=\"roomcal_rig\">\n");
  write_worked_point(record, out);
  out.text("  <link name=\"rig\"/>\n");
  for (const store::SensorRecord& sensor : record.sensors) write_joint(sensor, out);
  out.text("</robot>\n");
}

void write_ros_tf(const store::Record& record, TextWriter& out) {
  write_top(record, out);
  out.text("<launch>\n");
  write_worked_point(record, out);
  for (const store::SensorRecord& sensor : record.sensors) write_node(sensor, out);
  out.text("</launch>\n");
}

}  // namespace roomcal::exports
