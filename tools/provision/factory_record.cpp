#include "tools/provision/factory_record.h"

#include <string>

#include <fmt/format.h>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

store::SensorRecord at_nominal(const SensorName& name, const store::Serial& serial,
                               const calib::NominalMounting& nominal) {
  store::SensorRecord sensor;
  sensor.name = name;
  sensor.serial = serial;
  sensor.T_rig_sensor = nominal.T_rig_sensor;
  sensor.cov_rig_sensor.diagonal().head<3>().setConstant(nominal.sigma_t_m * nominal.sigma_t_m);
  sensor.cov_rig_sensor.diagonal().tail<3>().setConstant(nominal.sigma_rot_rad * nominal.sigma_rot_rad);
  return sensor;
}

void stamp(const profile::Profile& profile, store::Record& record) {
  record.action = store::Action::kProvisioned;
  record.generation = record.content_generation = store::kFactoryContent;
  record.previous_content = store::kNothingBefore;
  record.device_serial = profile.serial;
}

/// @return nullptr if the device has no sensor of this name and kind.
const store::Serial* serial_of(const profile::Profile& profile, const store::SensorRecord& sensor) {
  const auto find = [&](const auto& candidates) -> const store::Serial* {
    for (const auto& candidate : candidates)
      if (candidate.name.view() == sensor.name.view()) return &candidate.serial;
    return nullptr;
  };
  return sensor.kind == store::SensorKind::kCamera ? find(profile.cameras) : find(profile.lidars);
}

void take_serial(const profile::Profile& profile, const std::string& where, store::SensorRecord& sensor) {
  const store::Serial* serial = serial_of(profile, sensor);
  if (serial == nullptr)
    throw ToolError(fmt::format("{}: {} is not a sensor of {}; is it another device's?", where, sensor.name.view(),
                                profile.device.view()));
  if (!serial->empty() && !sensor.serial.empty() && serial->view() != sensor.serial.view())
    throw ToolError(fmt::format("{}: {} had serial {} when it was measured and has {} now; calibrate again", where,
                                sensor.name.view(), sensor.serial.view(), serial->view()));
  if (!serial->empty()) sensor.serial = *serial;
}

}  // namespace

store::Record factory_record(const profile::Profile& profile) {
  store::Record record;
  stamp(profile, record);
  record.verdict = Verdict::kPassAdvise;
  static_cast<void>(record.reasons.push_back("factory: nominal mounting by the drawing, not measured: calibrate"));
  record.map_id = "none";
  record.firmware_id = "roomcal provision";
  for (std::size_t i = 0; i < profile.cameras.size(); ++i) {
    const profile::CameraProfile& camera = profile.cameras[i];
    const bool is_reference = i == profile.reference;
    if (!is_reference && !camera.nominal.known) continue;
    store::SensorRecord sensor =
        at_nominal(camera.name, camera.serial, is_reference ? calib::NominalMounting() : camera.nominal);
    sensor.intrinsics = camera.intrinsics;
    if (is_reference) record.reference = record.sensors.size();
    static_cast<void>(record.sensors.push_back(sensor));
  }
  for (const profile::LidarProfile& lidar : profile.lidars) {
    if (!lidar.nominal.known) continue;
    store::SensorRecord sensor = at_nominal(lidar.name, lidar.serial, lidar.nominal);
    sensor.kind = store::SensorKind::kLidar;
    sensor.model = lidar.model;
    static_cast<void>(record.sensors.push_back(sensor));
  }
  return record;
}

store::Record factory_record(const profile::Profile& profile, store::Record measured,
                             const std::filesystem::path& file) {
  const std::string where = file.string();
  if (!may_write(measured.verdict))
    throw ToolError(
        fmt::format("{}: its verdict is {}; a factory record has passed", where, to_string(measured.verdict)));
  const std::string_view reference = measured.sensors[measured.reference].name.view();
  const std::string_view wanted = profile.cameras[profile.reference].name.view();
  if (reference != wanted)
    throw ToolError(fmt::format("{}: its reference is {}, this device's is {}; calibrate with this device.yaml", where,
                                reference, wanted));
  for (store::SensorRecord& sensor : measured.sensors) take_serial(profile, where, sensor);
  stamp(profile, measured);
  return measured;
}

}  // namespace roomcal::tools
