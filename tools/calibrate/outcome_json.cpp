#include "tools/calibrate/outcome_json.h"

#include <string>

#include <fmt/core.h>

#include "runtime/rig/pixel_error.h"
#include "tools/common/matrix_json.h"
#include "tools/device/device.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

json intrinsics_json(const camera::Intrinsics& k) {
  return {{"model", to_string(k.model)},
          {"width_px", k.width_px},
          {"height_px", k.height_px},
          {"fx_px", k.fx_px},
          {"fy_px", k.fy_px},
          {"cx_px", k.cx_px},
          {"cy_px", k.cy_px},
          {"distortion", k.distortion}};
}

/// Parameter by parameter: sigma before and after, and whether this shot or the prior tells it.
json refinement_json(const rig::RefinedLens& lens) {
  json out = json::object();
  for (std::size_t k = 0; k < camera::kParameterNames.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    out[camera::kParameterNames[k]] = {{"prior", lens.prior[i]},
                                       {"prior_sigma", lens.prior_sigma[i]},
                                       {"sigma", lens.sigma[i]},
                                       {"told_by", lens.told_by_shot(i) ? "shot" : "prior"}};
  }
  return out;
}

json sensor_json(const calib::CameraOutcome& camera, const rig::RigSolution& solution) {
  json out = {{"kind", "camera"},
              {"located", camera.located},
              {"intrinsics", intrinsics_json(camera.camera.intrinsics())},
              {"detections", camera.usable_detections},
              {"seen", camera.detections.size()},
              {"inliers", camera.inliers.size()}};
  if (!camera.failure.empty()) out["failure"] = std::string(camera.failure.view());
  if (camera.located) {
    out["T_room_sensor"] = rows_of(camera.T_room_cam.matrix());
    out["rms_px"] = camera.rms_px;
    out["coverage"] = camera.coverage;
    out["log_likelihood_gap"] = camera.log_likelihood_gap;
    if (const rig::RefinedLens* lens = solution.lens_of(camera.view)) out["intrinsics_sigma"] = refinement_json(*lens);
  }
  if (camera.in_rig) {
    out["T_rig_sensor"] = rows_of(camera.T_rig_cam.matrix());
    out["covariance"] = rows_of(camera.cov_rig_cam);
  }
  return out;
}

json weak_json(const scan::WeakDirection& weak, const SE3& T_room_lidar, const SE3& T_rig_lidar) {
  const auto axis = [](const Vec3& v) { return json{v.x(), v.y(), v.z()}; };
  const Vec3 axis_sensor = T_room_lidar.R.transpose() * weak.axis_room;
  return {{"kind", weak.rotation ? "rotation" : "position"},
          {"axis_room", axis(weak.axis_room)},
          {"axis_sensor", axis(axis_sensor)},
          {"axis_rig", axis(T_rig_lidar.R * axis_sensor)},
          {weak.rotation ? "sigma_rad" : "sigma_m", weak.sigma},
          {"text", std::string(scan::describe(weak).view())}};
}

json beams_json(const scan::Location& location) {
  json beams = json::array();
  for (std::size_t k = 0; k < location.beam_count; ++k) {
    const scan::BeamOffset& beam = location.beam[k];
    if (beam.points > 0)
      beams.push_back({{"beam", k}, {"offset_m", beam.offset_m}, {"sigma_m", beam.sigma_m}, {"points", beam.points}});
  }
  return beams;
}

json sensor_json(const calib::LidarOutcome& lidar, const calib::LidarSpec& spec, const std::string& file) {
  const scan::Location& location = lidar.location;
  json out = {{"kind", "lidar"},
              {"model", std::string(spec.model.view())},
              {"located", lidar.located},
              {"sweeps", lidar.sweeps},
              {"used_sweeps", lidar.used_sweeps},
              {"detections", location.points},
              {"inliers", location.inliers},
              {"twins", location.twins}};
  if (!file.empty()) out["file"] = file;
  if (!lidar.failure.empty()) out["failure"] = std::string(lidar.failure.view());
  if (lidar.located) {
    out["T_room_sensor"] = rows_of(lidar.T_room_lidar.matrix());
    out["rms_m"] = location.rms_m;
    out["sigma_m"] = location.sigma_m;
    out["coverage"] = location.azimuth;
    out["beam_offsets"] = beams_json(location);
    out["mounting_took_part"] = lidar.mount_took_part;
    json weak = json::array();
    for (const scan::WeakDirection& direction : location.weak)
      weak.push_back(weak_json(direction, lidar.T_room_lidar, lidar.T_rig_lidar));
    out["weak_directions"] = std::move(weak);
  }
  if (lidar.in_rig) {
    out["T_rig_sensor"] = rows_of(lidar.T_rig_lidar.matrix());
    out["covariance"] = rows_of(lidar.cov_rig_lidar);
  }
  return out;
}

/// Where points of b appear in camera a, 1-sigma, because of T_a_b: by distance.
json pixel_errors(const calib::Outcome& outcome, std::size_t a, const rig::RelativePose& T_a_b) {
  json errors = json::array();
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
    if (!outcome.cameras[i].located || outcome.cameras[i].view != a) continue;
    for (const double distance_m : rig::kPixelErrorDistances_m)
      errors.push_back(
          {{"distance_m", distance_m},
           {"sigma_px", rig::predicted_pixel_error(outcome.cameras[i].camera, T_a_b.T_a_b, T_a_b.cov, distance_m)}});
  }
  return errors;
}

json pairs_json(const calib::Outcome& outcome) {
  json pairs = json::array();
  const auto sensors = calib::located_sensors(outcome);
  for (const calib::LocatedSensor& a : sensors)
    for (const calib::LocatedSensor& b : sensors) {
      if (&a == &b) continue;
      const rig::RelativePose relative = rig::relative_pose(outcome.solution, a.number, b.number);
      pairs.push_back({{"a", std::string(a.name.view())},
                       {"b", std::string(b.name.view())},
                       {"T_a_b", rows_of(relative.T_a_b.matrix())},
                       {"covariance", rows_of(relative.cov)}});
      json errors = pixel_errors(outcome, a.number, relative);
      if (!errors.empty()) pairs.back()["pixel_error"] = std::move(errors);
    }
  return pairs;
}

json installed_json(const calib::InstalledCheck& check) {
  json sensors = json::object();
  for (const calib::SensorChange& change : check.sensors) {
    json one = {{"comparable", change.comparable}};
    if (change.comparable) {
      one["delta"] = std::vector<double>(change.delta.data(), change.delta.data() + 6);
      one["covariance"] = rows_of(change.cov);
      one["p_value"] = change.p_value;
    }
    sensors[std::string(change.name.view())] = std::move(one);
  }
  json out = {{"moved", check.moved}, {"p_value", check.p_value}, {"sensors", std::move(sensors)}};
  if (check.moved) out["moved_sensor"] = std::string(check.moved_sensor.view());
  return out;
}

json timing_json(const calib::Outcome& outcome) {
  json timing_ms = json::object();
  int64_t total_ns = 0;
  for (std::size_t s = 0; s < outcome.stage_ns.size(); ++s) {
    timing_ms[calib::to_string(static_cast<calib::Stage>(s))] = 1e-6 * static_cast<double>(outcome.stage_ns[s]);
    total_ns += outcome.stage_ns[s];
  }
  timing_ms["total"] = 1e-6 * static_cast<double>(total_ns);
  return timing_ms;
}

}  // namespace

json to_json(const calib::Outcome& outcome, const calib::Device& device, const map::RoomMap& map,
             const ResultContext& context) {
  json sensors = json::object();
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i)
    sensors[std::string(outcome.cameras[i].name.view())] = sensor_json(outcome.cameras[i], outcome.solution);
  for (std::size_t i = 0; i < outcome.lidars.size(); ++i)
    sensors[std::string(outcome.lidars[i].name.view())] =
        sensor_json(outcome.lidars[i], device.lidars[i], context.lidar_files[i]);
  json reasons = json::array();
  for (const Reason& reason : outcome.reasons) reasons.push_back(std::string(reason.view()));
  json solution;
  if (outcome.solution.degrees_of_freedom > 0)
    solution = {{"chi2", outcome.solution.chi2},
                {"degrees_of_freedom", outcome.solution.degrees_of_freedom},
                {"iterations", outcome.solution.iterations}};
  json out = {{"verdict", calib::to_string(outcome.verdict)},
              {"reasons", std::move(reasons)},
              {"rig_frame", std::string(outcome.cameras[outcome.reference].name.view())},
              {"map", {{"id", std::string(map.map_id())}, {"hash", fmt::format("{:08x}", map.content_crc32c())}}},
              {"device", context.device},
              {"device_serial", context.device_serial},
              {"firmware", context.firmware},
              {"measured_unix_s", context.measured_unix_s},
              {"sensors", std::move(sensors)},
              {"pairs", pairs_json(outcome)},
              {"joint_fit", std::move(solution)},
              {"timing_ms", timing_json(outcome)},
              {"arena_peak_bytes", context.arena_peak_bytes}};
  if (outcome.held_out.markers > 0)
    out["held_out"] = {{"markers", outcome.held_out.markers}, {"median_sigmas", outcome.held_out.median_sigmas}};
  if (outcome.installed.done) out["installed"] = installed_json(outcome.installed);
  return out;
}

}  // namespace roomcal::tools
