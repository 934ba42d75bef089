#include <fmt/core.h>

#include "tools/bake/survey.h"
#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/device/device_yaml.h"
#include "tools/device/kalibr.h"

namespace roomcal::tools {

namespace {

Device read_either(const std::filesystem::path& path) {
  const std::string text = read_text(path);
  const bool is_device = text.find("\nsensors:") != std::string::npos || text.starts_with("sensors:");
  return is_device ? parse_device_yaml(path.string(), text) : parse_kalibr(path.string(), text);
}

camera::Camera make_camera(const Sensor& sensor, const std::filesystem::path& path) {
  const Result<camera::Camera> camera = camera::Camera::create(sensor.intrinsics);
  require(camera.status(), path.string() + ": " + sensor.name);
  return camera.value();
}

SE3 T_rig_sensor(const Device& device, const Sensor& sensor, const std::filesystem::path& path) {
  if (sensor.name == device.rig_frame) return {};
  if (sensor.nominal) return sensor.nominal->T_rig_sensor;
  throw ToolError(
      fmt::format("{}: {} has no mounting (T_cn_cnm1 or nominal): a survey needs the calibrated stereo pair",
                  path.string(), sensor.name));
}

}  // namespace

bool StereoRig::in_image(Side side, const Vec2& px, double margin_px) const {
  const camera::Intrinsics& k = cameras[side].intrinsics();
  return px.x() >= margin_px && px.y() >= margin_px && px.x() <= k.width_px - 1 - margin_px &&
         px.y() <= k.height_px - 1 - margin_px;
}

StereoRig read_stereo_rig(const std::filesystem::path& path) {
  const Device device = read_either(path);
  std::vector<const Sensor*> cameras;
  for (const Sensor& sensor : device.sensors) {
    if (sensor.kind == SensorKind::kCamera) cameras.push_back(&sensor);
  }
  if (cameras.size() < 2) {
    throw ToolError(path.string() + ": a survey needs two cameras, left and right; calibrate the pair with Kalibr");
  }
  StereoRig rig{{make_camera(*cameras[kLeft], path), make_camera(*cameras[kRight], path)}, {}};
  rig.T_right_left =
      T_rig_sensor(device, *cameras[kRight], path).inverse() * T_rig_sensor(device, *cameras[kLeft], path);
  if (rig.baseline_m() < 1e-3) {
    throw ToolError(path.string() + ": the two cameras are at the same place; a survey needs a baseline");
  }
  return rig;
}

}  // namespace roomcal::tools
