#include "tools/provision/to_profile.h"

#include <fmt/format.h>

#include "runtime/calib/lidar_models.h"
#include "runtime/profile/driver_check.h"
#include "tools/common/error.h"
#include "tools/sweep/calibration_files.h"

namespace roomcal::tools {

namespace {

namespace fs = std::filesystem;

template <std::size_t kCapacity>
FixedText<kCapacity> fixed(const std::string& text, const std::string& what) {
  if (text.size() > kCapacity) throw ToolError(fmt::format("{}: at most {} characters", what, kCapacity));
  return FixedText<kCapacity>(std::string_view(text));
}

calib::NominalMounting to_mounting(const Sensor& sensor) {
  if (!sensor.nominal) return {};
  return {true, sensor.nominal->T_rig_sensor, sensor.nominal->sigma_rot_rad, sensor.nominal->sigma_t_m};
}

profile::CameraProfile to_camera(const Sensor& sensor, const std::string& where) {
  profile::CameraProfile camera;
  camera.name = std::string_view(sensor.name);
  camera.serial = fixed<store::Serial::capacity()>(sensor.serial, where + ": serial");
  camera.intrinsics = sensor.intrinsics;
  camera.sigma_px = sensor.sigma_px;
  camera.nominal = to_mounting(sensor);
  camera.wiring = sensor.camera_wiring;
  return camera;
}

profile::LidarProfile to_lidar(const Sensor& sensor, const fs::path& folder, const std::string& where) {
  const lidar::ModelInfo* model = calib::packets_of(sensor.lidar_model);
  if (model == nullptr || calib::ranges_of(sensor.lidar_model) == nullptr)
    throw ToolError(
        fmt::format("{}: LiDAR model '{}' is not known; `roomcal sweep --help` lists them, a terrestrial "
                    "scanner is 'tls'",
                    where, sensor.lidar_model));
  profile::LidarProfile lidar;
  lidar.name = std::string_view(sensor.name);
  lidar.serial = fixed<store::Serial::capacity()>(sensor.serial, where + ": serial");
  lidar.model = std::string_view(sensor.lidar_model);
  lidar.nominal = to_mounting(sensor);
  lidar.wiring = sensor.lidar_wiring;
  lidar.on_turntable = sensor.turntable.has_value();
  if (sensor.turntable) lidar.turntable = *sensor.turntable;
  if (lidar.wiring.port == 0) lidar.wiring.port = model->data_port;
  if (model->angles == lidar::AngleSource::kUnitRequired && sensor.calibration_file.empty())
    throw ToolError(
        fmt::format("{}: {}: its angles are the unit's own; name its file as `calibration`", where, model->product));
  const fs::path angles = sensor.calibration_file.empty() ? fs::path() : folder / sensor.calibration_file;
  lidar.calibration = read_calibration(model->model, angles);
  return lidar;
}

}  // namespace

profile::Profile to_profile(const Device& device, const fs::path& file) {
  const std::string where = file.string();
  profile::Profile profile;
  profile.device = fixed<store::LongId::capacity()>(device.name, where + ": name");
  profile.serial = fixed<store::Serial::capacity()>(device.serial, where + ": serial");
  profile.reference = calib::kMaxCameras;
  for (const Sensor& sensor : device.sensors) {
    const std::string here = where + ": " + sensor.name;
    if (sensor.kind == SensorKind::kLidar) {
      if (!profile.lidars.push_back(to_lidar(sensor, file.parent_path(), here)))
        throw ToolError(fmt::format("{}: more than {} LiDARs; split the device", where, calib::kMaxLidars));
      continue;
    }
    if (sensor.name == device.rig_frame) profile.reference = profile.cameras.size();
    if (!profile.cameras.push_back(to_camera(sensor, here)))
      throw ToolError(fmt::format("{}: more than {} cameras; split the device", where, calib::kMaxCameras));
  }
  profile.limits = device.limits;
  profile.grab = device.grab;
  profile.wiring = device.wiring;
  Reason what;
  if (!check_profile(profile, what).ok() || !check_drivers(profile, what).ok())
    throw ToolError(where + ": " + std::string(what.view()));
  return profile;
}

}  // namespace roomcal::tools
