#include "tools/report/compare_poses.h"

#include <vector>

#include <Eigen/Cholesky>

#include "runtime/calib/compare_installed.h"
#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/matrix_json.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

json difference(const Vec6& delta, const Mat66& cov) {
  const double chi2 = delta.dot(cov.ldlt().solve(delta));
  return {{"comparable", true},
          {"delta", std::vector<double>(delta.data(), delta.data() + 6)},
          {"covariance", rows_of(cov)},
          {"p_value", calib::chi_square_6_tail(chi2)}};
}

bool is_subject(const ResultFile& result, const SensorResult& sensor) {
  return sensor.T_rig_sensor && sensor.name != result.rig_frame;
}

/// T_reference_sensor of an installed calibration. It keeps no covariance between sensors: their errors count as
/// independent.
struct Relative {
  SE3 T;
  Mat66 cov;
};
Relative relative(const SensorResult& reference, const SensorResult& sensor) {
  Relative out;
  out.T = reference.T_rig_sensor->inverse() * *sensor.T_rig_sensor;
  const Mat66 Ad = se3_adjoint(out.T.inverse());
  out.cov = sensor.cov_rig_sensor + Ad * reference.cov_rig_sensor * Ad.transpose();
  return out;
}

SE3 true_pose(const json& truth, const std::string& sensor) {
  const json& poses = truth.at("T_room_sensor");
  if (!poses.contains(sensor)) throw ToolError("says nothing of " + sensor + "; is it the truth of another device?");
  return SE3::from_matrix(matrix_of<4>(poses.at(sensor).at("T")));
}

json compare_with_truth(const ResultFile& now, const json& truth) {
  json out = json::object();
  const SE3 T_rig_room = true_pose(truth, now.rig_frame).inverse();
  for (const SensorResult& sensor : now.sensors) {
    if (!is_subject(now, sensor)) continue;
    const SE3 T_rig_sensor_true = T_rig_room * true_pose(truth, sensor.name);
    out[sensor.name] = difference(se3_log(sensor.T_rig_sensor->inverse() * T_rig_sensor_true), sensor.cov_rig_sensor);
  }
  return out;
}

}  // namespace

json against_installed(const ResultFile& now, const ResultFile& installed) {
  json out = json::object();
  const SensorResult* reference = installed.find(now.rig_frame);
  for (const SensorResult& sensor : now.sensors) {
    if (!is_subject(now, sensor)) continue;
    const SensorResult* other = installed.find(sensor.name);
    if (reference == nullptr || !reference->T_rig_sensor || other == nullptr || !other->T_rig_sensor) {
      out[sensor.name] = {{"comparable", false}};
      continue;
    }
    const Relative then = relative(*reference, *other);
    out[sensor.name] = difference(se3_log(then.T.inverse() * *sensor.T_rig_sensor), then.cov + sensor.cov_rig_sensor);
  }
  return out;
}

json against_truth(const ResultFile& now, const std::filesystem::path& truth_file) {
  try {
    return compare_with_truth(now, json::parse(read_text(truth_file)));
  } catch (const json::exception& error) {
    throw ToolError(truth_file.string() + ": is not the truth of a simulated shot: " + error.what());
  } catch (const ToolError& error) {
    const std::string what = error.what();
    if (what.starts_with(truth_file.string())) throw;
    throw ToolError(truth_file.string() + ": " + what);
  }
}

}  // namespace roomcal::tools
