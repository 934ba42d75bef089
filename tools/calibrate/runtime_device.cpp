#include "tools/calibrate/runtime_device.h"

#include <fmt/core.h>

#include "runtime/calib/lidar_models.h"
#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

calib::NominalMounting to_mounting(const Sensor& sensor) {
  if (!sensor.nominal) return {};
  return {true, sensor.nominal->T_rig_sensor, sensor.nominal->sigma_rot_rad, sensor.nominal->sigma_t_m};
}

calib::CameraSpec to_spec(const Sensor& sensor, const std::string& source) {
  const Result<camera::Camera> camera = camera::Camera::create(sensor.intrinsics);
  require(camera.status(), source + ": " + sensor.name);
  return {std::string_view(sensor.name),
          camera.value(),
          to_mounting(sensor),
          sensor.sigma_px,
          sensor.intrinsics_sigma.value_or(camera::usual_sigma(sensor.intrinsics)),
          std::string_view(sensor.serial)};
}

calib::LidarSpec to_lidar(const Sensor& sensor, const std::string& source) {
  const scan::SensorModel* ranges = calib::ranges_of(sensor.lidar_model);
  if (ranges == nullptr)
    throw ToolError(
        fmt::format("{}: {}: LiDAR model '{}' is not known; `roomcal sweep --help` lists them, a terrestrial "
                    "scanner is 'tls'",
                    source, sensor.name, sensor.lidar_model));
  return {std::string_view(sensor.name), std::string_view(sensor.lidar_model), *ranges, to_mounting(sensor),
          std::string_view(sensor.serial)};
}

}  // namespace

calib::Device to_runtime(const Device& device, const std::string& source) {
  calib::Device out;
  bool has_reference = false;
  for (const Sensor& sensor : device.sensors) {
    if (sensor.kind == SensorKind::kLidar) {
      if (!out.lidars.push_back(to_lidar(sensor, source)))
        throw ToolError(fmt::format("{}: more than {} LiDARs; split the device", source, calib::kMaxLidars));
      continue;
    }
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
