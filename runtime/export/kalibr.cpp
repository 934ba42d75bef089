#include "runtime/export/formats.h"
#include "runtime/export/frames.h"

namespace roomcal::exports {

namespace {

void write_rows(const SE3& T, TextWriter& out) {
  const Mat44 rows = T.matrix();
  for (int r = 0; r < 4; ++r) {
    out.text("  - [");
    for (int c = 0; c < 4; ++c) out.text(c == 0 ? "" : ", ").number(rows(r, c));
    out.text("]\n");
  }
}

void write_intrinsics(const store::SensorRecord& camera, TextWriter& out) {
  const camera::Intrinsics& k = camera.intrinsics;
  out.text("  cam_overlaps: []\n  camera_model: pinhole\n  distortion_model: ");
  out.text(k.model == camera::Model::kPinholeRadtan ? "radtan" : "equidistant").text("\n  distortion_coeffs: [");
  for (std::size_t i = 0; i < k.distortion.size(); ++i) out.text(i == 0 ? "" : ", ").number(k.distortion[i]);
  out.text("]\n  intrinsics: [").number(k.fx_px).text(", ").number(k.fy_px).text(", ");
  out.number(k.cx_px).text(", ").number(k.cy_px).text("]\n  resolution: [").integer(k.width_px).text(", ");
  out.integer(k.height_px).text("]\n  rostopic: /").text(camera.name.view()).text("/image_raw\n");
}

}  // namespace

// Kalibr counts the top-level keys to know how many cameras there are, so what else there is to say is a comment.
void write_kalibr(const store::Record& record, TextWriter& out) {
  out.text("# ");
  write_origin(record, out);
  out.text("\n# T_cn_cnm1 takes points of the camera before to this camera (metres). LiDARs are left out.\n");
  const store::SensorRecord* before = nullptr;
  const store::SensorRecord* first = nullptr;
  std::size_t number = 0;
  for (const store::SensorRecord& sensor : record.sensors) {
    if (sensor.kind != store::SensorKind::kCamera) continue;
    out.text("cam").unsigned_integer(number++).text(":  # ").text(sensor.name.view()).text("\n");
    write_intrinsics(sensor, out);
    if (before != nullptr) {
      out.text("  T_cn_cnm1:\n");
      write_rows(sensor.T_rig_sensor.inverse() * before->T_rig_sensor, out);
    } else {
      first = &sensor;
    }
    before = &sensor;
  }
  const WorkedPoint point = worked_point(record, true);
  if (point.sensor == nullptr || first == nullptr) return;
  out.text("# worked point: (");
  write_triple(point.p_sensor, out);
  out.text(") in ").text(point.sensor->name.view()).text(" is (");
  write_triple(first->T_rig_sensor.inverse() * point.p_rig, out);
  out.text(") in ").text(first->name.view()).text("\n");
}

}  // namespace roomcal::exports
