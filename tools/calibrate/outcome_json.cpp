#include "tools/calibrate/outcome_json.h"

#include <string>

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

json sensor_json(const calib::CameraOutcome& camera) {
  json out = {{"located", camera.located},
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

json to_json(const calib::Outcome& outcome, std::size_t arena_peak_bytes) {
  json sensors = json::object(), timing_ms = json::object();
  for (const calib::CameraOutcome& camera : outcome.cameras)
    sensors[std::string(camera.name.view())] = sensor_json(camera);
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
          {"sensors", std::move(sensors)},
          {"pairs", pairs_json(outcome)},
          {"joint_fit", std::move(solution)},
          {"timing_ms", std::move(timing_ms)},
          {"arena_peak_bytes", arena_peak_bytes}};
}

}  // namespace roomcal::tools
