#include <array>
#include <span>

#include "runtime/export/formats.h"
#include "runtime/export/frames.h"

namespace roomcal::exports {

namespace {

void write_matrix(std::string_view name, int rows, int cols, std::span<const double> data, TextWriter& out) {
  out.text("   ").text(name).text(": !!opencv-matrix\n      rows: ").integer(rows).text("\n      cols: ").integer(cols);
  out.text("\n      dt: d\n      data: [ ");
  for (std::size_t i = 0; i < data.size(); ++i)
    out.text(i == 0 ? "" : i % 4 == 0 ? ",\n          " : ", ").number(data[i]);
  out.text(" ]\n");
}

void write_pose(const SE3& T_rig_sensor, TextWriter& out) {
  std::array<double, 16> rows{};
  const Mat44 T = T_rig_sensor.matrix();
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = T(static_cast<int>(i / 4), static_cast<int>(i % 4));
  write_matrix("camera_pose_matrix", 4, 4, rows, out);
}

void write_intrinsics(const camera::Intrinsics& k, TextWriter& out) {
  const std::array<double, 9> K{k.fx_px, 0, k.cx_px, 0, k.fy_px, k.cy_px, 0, 0, 1};
  write_matrix("camera_matrix", 3, 3, K, out);
  write_matrix("distortion_vector", 1, 4, k.distortion, out);
  out.text("   distortion_type: ").integer(k.model == camera::Model::kKannalaBrandt ? 1 : 0);
  out.text("\n   img_width: ").integer(k.width_px).text("\n   img_height: ").integer(k.height_px).text("\n");
}

void write_vector(std::string_view name, const Vec3& v, TextWriter& out) {
  const std::array<double, 3> data{v.x(), v.y(), v.z()};
  write_matrix(name, 3, 1, data, out);
}

}  // namespace

// Keys as MC-Calib's camera files; LiDARs follow in the same form under keys of their own.
void write_opencv(const store::Record& record, TextWriter& out) {
  out.text("%YAML:1.0\n---\n# ");
  write_origin(record, out);
  out.text("\n# camera_pose_matrix takes points of the sensor to the rig, the frame of ");
  out.text(record.sensors[record.reference].name.view())
      .text(". Metres. distortion_type: 0 radial-tangential, 1 fisheye.\n");
  std::size_t cameras = 0, lidars = 0;
  for (const store::SensorRecord& sensor : record.sensors) cameras += sensor.kind == store::SensorKind::kCamera ? 1 : 0;
  out.text("nb_camera: ").unsigned_integer(cameras).text("\n");
  cameras = 0;
  for (const store::SensorRecord& sensor : record.sensors) {
    const bool is_camera = sensor.kind == store::SensorKind::kCamera;
    out.text(is_camera ? "camera_" : "lidar_").unsigned_integer(is_camera ? cameras++ : lidars++);
    out.text(":\n   name: ").quoted(sensor.name.view()).text("\n");
    if (is_camera) write_intrinsics(sensor.intrinsics, out);
    out.text("   camera_group: 0\n");
    write_pose(sensor.T_rig_sensor, out);
  }
  const WorkedPoint point = worked_point(record, false);
  out.text("worked_point:\n   sensor: ").quoted(point.sensor->name.view()).text("\n");
  write_vector("p_sensor", point.p_sensor, out);
  write_vector("p_rig", point.p_rig, out);
}

}  // namespace roomcal::exports
