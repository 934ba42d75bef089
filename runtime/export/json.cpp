#include <cmath>

#include "runtime/export/formats.h"
#include "runtime/export/frames.h"

namespace roomcal::exports {

namespace {

template <typename Matrix>
void write_rows(const Matrix& m, TextWriter& out) {
  out.text("[");
  for (Eigen::Index r = 0; r < m.rows(); ++r) {
    out.text(r == 0 ? "[" : ", [");
    for (Eigen::Index c = 0; c < m.cols(); ++c) out.text(c == 0 ? "" : ", ").number(m(r, c));
    out.text("]");
  }
  out.text("]");
}

void write_point(const Vec3& p, TextWriter& out) {
  out.text("[");
  write_triple(p, out);
  out.text("]");
}

void write_generation(uint64_t generation, TextWriter& out) {
  if (generation == store::kNothingBefore)
    out.text("null");
  else
    out.unsigned_integer(generation);
}

void write_intrinsics(const camera::Intrinsics& k, TextWriter& out) {
  out.text(",\n      \"intrinsics\": {\"model\": ");
  out.quoted(k.model == camera::Model::kPinholeRadtan ? "pinhole_radtan" : "kannala_brandt");
  out.text(", \"width_px\": ").integer(k.width_px).text(", \"height_px\": ").integer(k.height_px);
  out.text(", \"fx_px\": ").number(k.fx_px).text(", \"fy_px\": ").number(k.fy_px);
  out.text(", \"cx_px\": ").number(k.cx_px).text(", \"cy_px\": ").number(k.cy_px).text(", \"distortion\": [");
  for (std::size_t i = 0; i < k.distortion.size(); ++i) out.text(i == 0 ? "" : ", ").number(k.distortion[i]);
  out.text("]}");
}

void write_sensor(const store::SensorRecord& sensor, TextWriter& out) {
  const bool is_camera = sensor.kind == store::SensorKind::kCamera;
  out.text("    ").quoted(sensor.name.view()).text(": {\n      \"kind\": ").quoted(is_camera ? "camera" : "lidar");
  out.text(", \"model\": ").quoted(sensor.model.view()).text(", \"serial\": ").quoted(sensor.serial.view());
  out.text(",\n      \"T_rig_sensor\": ");
  write_rows(sensor.T_rig_sensor.matrix(), out);
  out.text(",\n      \"covariance\": ");
  write_rows(sensor.cov_rig_sensor, out);
  if (is_camera) write_intrinsics(sensor.intrinsics, out);
  const store::Evidence& e = sensor.evidence;
  out.text(",\n      \"detections\": ")
      .unsigned_integer(e.detections)
      .text(", \"inliers\": ")
      .unsigned_integer(e.inliers);
  out.text(is_camera ? ", \"rms_px\": " : ", \"rms_m\": ").number(e.rms).text(", \"coverage\": ").number(e.coverage);
  out.text(", \"log_likelihood_gap\": ").number(e.log_likelihood_gap).text("\n    }");
}

void write_stamp(const store::Record& record, TextWriter& out) {
  out.text("{\n  \"format\": \"roomcal-record\",\n  \"version\": 1,\n  \"generation\": ")
      .unsigned_integer(record.generation);
  out.text(",\n  \"content_generation\": ")
      .unsigned_integer(record.content_generation)
      .text(",\n  \"previous_content\": ");
  write_generation(record.previous_content, out);
  out.text(",\n  \"action\": ")
      .quoted(to_string(record.action))
      .text(",\n  \"verdict\": ")
      .quoted(to_string(record.verdict));
  out.text(",\n  \"reasons\": [");
  for (std::size_t i = 0; i < record.reasons.size(); ++i) out.text(i == 0 ? "" : ", ").quoted(record.reasons[i].view());
  out.text("],\n  \"map\": {\"id\": ").quoted(record.map_id.view()).text(", \"hash\": \"").hex(record.map_hash);
  out.text("\"},\n  \"firmware\": ").quoted(record.firmware_id.view());
  out.text(",\n  \"device_serial\": ").quoted(record.device_serial.view());
  out.text(",\n  \"measured_unix_s\": ").integer(record.measured_unix_s);
  out.text(",\n  \"written_unix_s\": ").integer(record.written_unix_s).text(",\n  \"temperature_c\": ");
  if (std::isnan(record.temperature_c))
    out.text("null");
  else
    out.number(record.temperature_c);
  out.text(",\n  \"trigger\": ").quoted(record.trigger.view());
  out.text(",\n  \"joint_fit\": {\"chi2\": ").number(record.chi2).text(", \"degrees_of_freedom\": ");
  out.unsigned_integer(record.degrees_of_freedom).text("},\n");
}

}  // namespace

void write_json(const store::Record& record, TextWriter& out) {
  write_stamp(record, out);
  out.text("  \"rig_frame\": ").quoted(record.sensors[record.reference].name.view()).text(",\n  \"sensors\": {\n");
  for (std::size_t i = 0; i < record.sensors.size(); ++i) {
    write_sensor(record.sensors[i], out);
    out.text(i + 1 == record.sensors.size() ? "\n" : ",\n");
  }
  const WorkedPoint point = worked_point(record, false);
  out.text("  },\n  \"worked_point\": {\"sensor\": ").quoted(point.sensor->name.view()).text(", \"p_sensor\": ");
  write_point(point.p_sensor, out);
  out.text(", \"p_rig\": ");
  write_point(point.p_rig, out);
  out.text("}\n}\n");
}

}  // namespace roomcal::exports
