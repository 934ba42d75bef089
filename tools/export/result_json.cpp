#include "tools/export/result_json.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "tools/common/error.h"
#include "tools/common/matrix_json.h"

namespace roomcal::tools {

using nlohmann::json;

namespace {

store::SensorRecord sensor(const std::string& name, const json& in) {
  store::SensorRecord out;
  if (name.size() > 31) throw ToolError("a sensor's name of more than 31 characters");
  out.name = std::string_view(name);
  out.kind = in.value("kind", "camera") == "lidar" ? store::SensorKind::kLidar : store::SensorKind::kCamera;
  out.model = std::string_view(in.value("model", std::string()));
  const Mat44 T = matrix_of<4>(in.at("T_rig_sensor"));
  out.T_rig_sensor = {T.topLeftCorner<3, 3>(), T.topRightCorner<3, 1>()};
  const Mat66 cov = matrix_of<6>(in.at("covariance"));
  out.cov_rig_sensor = 0.5 * (cov + cov.transpose());
  if (out.kind == store::SensorKind::kCamera) {
    if (!in.contains("intrinsics")) throw ToolError(name + " has no intrinsics; run `roomcal calibrate` again");
    out.intrinsics = parse_intrinsics(in.at("intrinsics"));
  }
  out.evidence.detections = in.value("detections", 0U);
  out.evidence.inliers = in.value("inliers", 0U);
  out.evidence.rms = in.value(out.kind == store::SensorKind::kCamera ? "rms_px" : "rms_m", 0.0);
  out.evidence.coverage = in.value("coverage", 0.0);
  out.evidence.log_likelihood_gap = in.value("log_likelihood_gap", 0.0);
  return out;
}

void take_stamp(const json& in, store::Record& record) {
  for (const Verdict verdict : {Verdict::kPass, Verdict::kPassAdvise, Verdict::kFailRetry, Verdict::kFailService})
    if (in.at("verdict") == to_string(verdict)) record.verdict = verdict;
  if (!may_write(record.verdict))
    throw ToolError("the verdict is " + in.at("verdict").get<std::string>() + ": nothing to export");
  const json reasons = in.value("reasons", json::array());
  for (std::size_t i = 0; i < std::min(reasons.size(), store::kMaxReasons); ++i)
    static_cast<void>(record.reasons.push_back(Reason(std::string_view(reasons[i].get<std::string>()))));
  if (!in.contains("map")) return;
  record.map_id = std::string_view(in.at("map").value("id", std::string()));
  record.map_hash = static_cast<uint32_t>(std::stoul(in.at("map").value("hash", std::string("0")), nullptr, 16));
}

store::Record parse(const std::string& text) {
  const json in = json::parse(text);
  store::Record record;
  take_stamp(in, record);
  bool has_reference = false;
  for (const auto& [name, value] : in.at("sensors").items()) {
    if (!value.contains("T_rig_sensor")) continue;  // not located
    if (name == in.at("rig_frame")) {
      record.reference = record.sensors.size();
      has_reference = true;
    }
    if (!record.sensors.push_back(sensor(name, value))) throw ToolError("more sensors than a record holds");
  }
  if (!has_reference) throw ToolError("the rig frame is not one of its sensors");
  const Status status = store::check_record(record);
  if (!status.ok()) throw ToolError(status.detail());
  return record;
}

}  // namespace

camera::Intrinsics parse_intrinsics(const nlohmann::json& in) {
  const bool radtan = in.at("model") == "pinhole_radtan";
  if (!radtan && in.at("model") != "kannala_brandt") throw ToolError("a camera model that is not known");
  camera::Intrinsics k;
  k.model = radtan ? camera::Model::kPinholeRadtan : camera::Model::kKannalaBrandt;
  k.width_px = in.at("width_px");
  k.height_px = in.at("height_px");
  k.fx_px = in.at("fx_px");
  k.fy_px = in.at("fy_px");
  k.cx_px = in.at("cx_px");
  k.cy_px = in.at("cy_px");
  k.distortion = in.at("distortion").get<std::array<double, camera::kDistortionCount>>();
  return k;
}

store::Record parse_result(const std::string& name, const std::string& text) {
  try {
    return parse(text);
  } catch (const ToolError& error) {
    throw ToolError(name + ": " + error.what());
  } catch (const std::exception& error) {  // of the JSON library, and numbers beyond any range
    throw ToolError(name + ": not a result of `roomcal calibrate --json`: " + error.what());
  }
}

}  // namespace roomcal::tools
