#include "tools/calibrate/outcome_json.h"

#include <string>

#include <fmt/core.h>

#include "tools/device/device.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

template <typename Matrix>
json rows(const Matrix& m) {
  json out = json::array();
  for (Eigen::Index r = 0; r < m.rows(); ++r) {
    json row = json::array();
    for (Eigen::Index c = 0; c < m.cols(); ++c) row.push_back(m(r, c));
    out.push_back(std::move(row));
  }
  return out;
}

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

json sensor_json(const calib::CameraOutcome& camera, const calib::CameraSpec& spec) {
  json out = {{"located", camera.located},
              {"intrinsics", intrinsics_json(spec.camera.intrinsics())},
              {"detections", camera.usable_detections},
              {"seen", camera.detections.size()},
              {"inliers", camera.inliers.size()}};
  if (!camera.failure.empty()) out["failure"] = std::string(camera.failure.view());
  if (camera.located) {
    out["T_room_sensor"] = rows(camera.T_room_cam.matrix());
    out["rms_px"] = camera.rms_px;
    out["coverage"] = camera.coverage;
    out["log_likelihood_gap"] = camera.log_likelihood_gap;
  }
  if (camera.in_rig) {
    out["T_rig_sensor"] = rows(camera.T_rig_cam.matrix());
    out["covariance"] = rows(camera.cov_rig_cam);
  }
  return out;
}

json pairs_json(const calib::Outcome& outcome) {
  json pairs = json::array();
  for (const calib::CameraOutcome& a : outcome.cameras)
    for (const calib::CameraOutcome& b : outcome.cameras) {
      if (&a == &b || !a.located || !b.located) continue;
      const rig::RelativePose relative = rig::relative_pose(outcome.solution, a.view, b.view);
      pairs.push_back({{"a", std::string(a.name.view())},
                       {"b", std::string(b.name.view())},
                       {"T_a_b", rows(relative.T_a_b.matrix())},
                       {"covariance", rows(relative.cov)}});
    }
  return pairs;
}

}  // namespace

json to_json(const calib::Outcome& outcome, const calib::Device& device, const map::RoomMap& map,
             std::size_t arena_peak_bytes) {
  json sensors = json::object(), timing_ms = json::object();
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i)
    sensors[std::string(outcome.cameras[i].name.view())] = sensor_json(outcome.cameras[i], device.cameras[i]);
  int64_t total_ns = 0;
  for (std::size_t s = 0; s < outcome.stage_ns.size(); ++s) {
    timing_ms[calib::to_string(static_cast<calib::Stage>(s))] = 1e-6 * static_cast<double>(outcome.stage_ns[s]);
    total_ns += outcome.stage_ns[s];
  }
  timing_ms["total"] = 1e-6 * static_cast<double>(total_ns);
  json reasons = json::array();
  for (const Reason& reason : outcome.reasons) reasons.push_back(std::string(reason.view()));
  json solution;
  if (outcome.solution.degrees_of_freedom > 0)
    solution = {{"chi2", outcome.solution.chi2},
                {"degrees_of_freedom", outcome.solution.degrees_of_freedom},
                {"iterations", outcome.solution.iterations}};
  return {{"verdict", calib::to_string(outcome.verdict)},
          {"reasons", std::move(reasons)},
          {"rig_frame", std::string(outcome.cameras[outcome.reference].name.view())},
          {"map", {{"id", std::string(map.map_id())}, {"hash", fmt::format("{:08x}", map.content_crc32c())}}},
          {"sensors", std::move(sensors)},
          {"pairs", pairs_json(outcome)},
          {"joint_fit", std::move(solution)},
          {"timing_ms", std::move(timing_ms)},
          {"arena_peak_bytes", arena_peak_bytes}};
}

}  // namespace roomcal::tools
