#include "tools/calibrate/runtime_device.h"

#include <fmt/core.h>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

calib::CameraSpec to_spec(const Sensor& sensor, const std::string& source) {
  const Result<camera::Camera> camera = camera::Camera::create(sensor.intrinsics);
  require(camera.status(), source + ": " + sensor.name);
  calib::CameraSpec spec{std::string_view(sensor.name), camera.value(), {}};
  if (sensor.nominal)
    spec.nominal = {true, sensor.nominal->T_rig_sensor, sensor.nominal->sigma_rot_rad, sensor.nominal->sigma_t_m};
  return spec;
}

}  // namespace

calib::Device to_runtime(const Device& device, const std::string& source) {
  calib::Device out;
  bool has_reference = false;
  for (const Sensor& sensor : device.sensors) {
    if (sensor.kind != SensorKind::kCamera) continue;
    if (sensor.name == device.rig_frame) {
      has_reference = true;
      out.reference = out.cameras.size();
    }
    if (!out.cameras.push_back(to_spec(sensor, source)))
      throw ToolError(fmt::format("{}: more than {} cameras; split the device", source, calib::kMaxCameras));
  }
  if (!has_reference)
    throw ToolError(fmt::format("{}: rig_frame {} is not one of its cameras; name a camera", source, device.rig_frame));
  return out;
}

}  // namespace roomcal::tools
