#include "runtime/calib/to_record.h"

#include "runtime/base/reason.h"

namespace roomcal::calib {

namespace {

store::SensorRecord to_sensor(const CameraOutcome& camera, const CameraSpec& spec) {
  store::SensorRecord sensor;
  sensor.name = camera.name;
  sensor.kind = store::SensorKind::kCamera;
  sensor.serial = spec.serial;
  sensor.T_rig_sensor = camera.T_rig_cam;
  sensor.cov_rig_sensor = 0.5 * (camera.cov_rig_cam + camera.cov_rig_cam.transpose());
  sensor.intrinsics = camera.camera.intrinsics();
  sensor.evidence = {static_cast<uint32_t>(camera.usable_detections), static_cast<uint32_t>(camera.inliers.size()),
                     camera.rms_px, camera.coverage, camera.log_likelihood_gap};
  return sensor;
}

store::SensorRecord to_sensor(const LidarOutcome& lidar, const LidarSpec& spec) {
  store::SensorRecord sensor;
  sensor.name = lidar.name;
  sensor.kind = store::SensorKind::kLidar;
  sensor.model = spec.model;
  sensor.serial = spec.serial;
  sensor.T_rig_sensor = lidar.T_rig_lidar;
  sensor.cov_rig_sensor = 0.5 * (lidar.cov_rig_lidar + lidar.cov_rig_lidar.transpose());
  sensor.evidence = {lidar.location.points, lidar.location.inliers, lidar.location.rms_m, lidar.location.azimuth, 0};
  return sensor;
}

void take_reasons(const Outcome& outcome, store::Record& record) {
  const std::size_t kept = std::min(outcome.reasons.size(), store::kMaxReasons);
  for (std::size_t i = 0; i < kept; ++i) static_cast<void>(record.reasons.push_back(outcome.reasons[i]));
  if (outcome.reasons.size() > kept)
    record.reasons.back() = make_reason("and %zu more reasons", outcome.reasons.size() - kept + 1);
}

}  // namespace

Status to_record(const Outcome& outcome, const Device& device, const RecordContext& context, store::Record& record) {
  if (outcome.cameras.size() != device.cameras.size() || outcome.lidars.size() != device.lidars.size() ||
      outcome.reference >= outcome.cameras.size())
    return {StatusCode::kInvalidArgument, "the outcome is not of this device"};
  if (!outcome.cameras[outcome.reference].in_rig)
    return {StatusCode::kNotFound, "the reference sensor was not located, so there is no rig frame"};
  record = {};
  record.verdict = outcome.verdict;
  take_reasons(outcome, record);
  record.map_id = context.map_id;
  record.map_hash = context.map_hash;
  record.firmware_id = context.firmware_id;
  record.device_serial = context.device_serial;
  record.measured_unix_s = context.measured_unix_s;
  record.temperature_c = context.temperature_c;
  record.trigger = context.trigger;
  record.chi2 = outcome.solution.chi2;
  record.degrees_of_freedom = static_cast<uint32_t>(outcome.solution.degrees_of_freedom);
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
    if (!outcome.cameras[i].in_rig) continue;
    if (i == outcome.reference) record.reference = record.sensors.size();
    if (!record.sensors.push_back(to_sensor(outcome.cameras[i], device.cameras[i])))
      return {StatusCode::kCapacity, "more sensors than a record holds"};
  }
  for (std::size_t i = 0; i < outcome.lidars.size(); ++i)
    if (outcome.lidars[i].in_rig && !record.sensors.push_back(to_sensor(outcome.lidars[i], device.lidars[i])))
      return {StatusCode::kCapacity, "more sensors than a record holds"};
  return store::check_record(record);
}

}  // namespace roomcal::calib
