#include <span>

#include "runtime/camera/camera.h"
#include "runtime/export/formats.h"
#include "runtime/export/frames.h"

namespace roomcal::exports {

namespace {

void write_matrix(std::string_view name, int rows, int cols, std::span<const double> data, TextWriter& out) {
  out.text(name).text(":\n  rows: ").integer(rows).text("\n  cols: ").integer(cols).text("\n  data: [");
  for (std::size_t i = 0; i < data.size(); ++i) out.text(i == 0 ? "" : ", ").number(data[i]);
  out.text("]\n");
}

}  // namespace

// camera_info has no extrinsics: its worked point goes from the camera's optical frame to the image, and to the rig.
void write_ros_info(const store::Record& record, const store::SensorRecord& sensor, TextWriter& out) {
  const camera::Intrinsics& k = sensor.intrinsics;
  const std::array<double, 9> K{k.fx_px, 0, k.cx_px, 0, k.fy_px, k.cy_px, 0, 0, 1};
  const std::array<double, 12> P{k.fx_px, 0, k.cx_px, 0, 0, k.fy_px, k.cy_px, 0, 0, 0, 1, 0};
  const std::array<double, 9> identity{1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::array<double, 5> D{k.distortion[0], k.distortion[1], k.distortion[2], k.distortion[3], 0};
  const bool fisheye = k.model == camera::Model::kKannalaBrandt;

  out.text("# ");
  write_origin(record, out);
  out.text("\nimage_width: ").integer(k.width_px).text("\nimage_height: ").integer(k.height_px);
  out.text("\ncamera_name: ").quoted(sensor.name.view()).text("\n");
  write_matrix("camera_matrix", 3, 3, K, out);
  out.text("distortion_model: ").text(fisheye ? "equidistant" : "plumb_bob").text("\n");
  write_matrix("distortion_coefficients", 1, fisheye ? 4 : 5, std::span(D).first(fisheye ? 4 : 5), out);
  write_matrix("rectification_matrix", 3, 3, identity, out);
  write_matrix("projection_matrix", 3, 4, P, out);

  const Vec3 p_cam(0.25, -0.5, 2.0);
  Vec2 px(0, 0);
  const Result<camera::Camera> camera = camera::Camera::create(k);
  if (!camera.ok() || !camera.value().project(p_cam, px).ok()) return;  // a lens that does not see that far to the side
  out.text("# worked point: (");
  write_triple(p_cam, out);
  out.text(") in ").text(sensor.name.view()).text(" is (");
  write_triple(sensor.T_rig_sensor * p_cam, out);
  out.text(") in rig and projects to (").number(px.x()).text(", ").number(px.y()).text(")\n");
}

}  // namespace roomcal::exports
