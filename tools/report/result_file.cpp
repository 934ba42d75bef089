#include "tools/report/result_file.h"

#include <string_view>
#include <utility>

#include "runtime/export/export.h"
#include "runtime/store/format.h"
#include "tools/common/error.h"
#include "tools/common/files.h"
#include "tools/common/matrix_json.h"
#include "tools/export/record_file.h"
#include "tools/export/result_json.h"

namespace roomcal::tools {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr std::size_t kRecordTextBytes = 64 * 1024;

std::string record_as_json(const fs::path& path) {
  std::vector<char> buffer(kRecordTextBytes);
  TextWriter out(buffer);
  require(exports::write(read_record(path), exports::Format::kJson, {}, out), path.string());
  return std::string(out.view());
}

std::optional<SE3> pose_at(const json& sensor, const char* key) {
  if (!sensor.contains(key)) return std::nullopt;
  return SE3::from_matrix(matrix_of<4>(sensor.at(key)));
}

camera::Camera camera_of(const json& sensor) {
  if (!sensor.contains("intrinsics")) throw ToolError("a camera without intrinsics; run `roomcal calibrate` again");
  const Result<camera::Camera> camera = camera::Camera::create(parse_intrinsics(sensor.at("intrinsics")));
  require(camera.status(), "intrinsics");
  return camera.value();
}

LidarResult lidar_of(const json& sensor) {
  LidarResult lidar;
  lidar.model = sensor.value("model", std::string());
  lidar.file = sensor.value("file", std::string());
  lidar.sweeps = sensor.value("sweeps", std::size_t{0});
  lidar.sigma_m = sensor.value("sigma_m", 0.0);
  for (const json& beam : sensor.value("beam_offsets", json::array())) {
    const auto number = beam.at("beam").get<std::size_t>();
    if (number >= lidar.beam_offset_m.size()) throw ToolError("a beam that no LiDAR has");
    lidar.beam_offset_m[number] = beam.at("offset_m").get<double>();
  }
  return lidar;
}

SensorResult sensor_of(const std::string& name, const json& in) {
  SensorResult sensor;
  sensor.name = name;
  sensor.T_room_sensor = pose_at(in, "T_room_sensor");
  sensor.T_rig_sensor = pose_at(in, "T_rig_sensor");
  if (sensor.T_rig_sensor) sensor.cov_rig_sensor = matrix_of<6>(in.at("covariance"));
  if (in.at("kind") == "lidar")
    sensor.lidar = lidar_of(in);
  else
    sensor.camera = camera_of(in);
  return sensor;
}

ResultFile parse(const std::string& text) {
  ResultFile result;
  result.json = json::parse(text);
  const json& in = result.json;
  if (!in.is_object() || !in.contains("verdict") || !in.contains("sensors") || !in.at("sensors").is_object())
    throw ToolError("holds no verdict and sensors");
  static_cast<void>(in.at("verdict").get<std::string>());
  for (const json& reason : in.value("reasons", json::array())) static_cast<void>(reason.get<std::string>());
  result.rig_frame = in.at("rig_frame").get<std::string>();
  for (const auto& [name, sensor] : in.at("sensors").items()) {
    try {
      result.sensors.push_back(sensor_of(name, sensor));
    } catch (const std::exception& error) {  // ours, and of the JSON library
      throw ToolError(name + ": " + error.what());
    }
  }
  return result;
}

}  // namespace

const SensorResult* ResultFile::find(const std::string& name) const {
  for (const SensorResult& sensor : sensors)
    if (sensor.name == name) return &sensor;
  return nullptr;
}

ResultFile read_result(const fs::path& path) {
  const std::string text = read_text(path);
  const std::string_view magic(store::kMagic.data(), store::kMagic.size());
  const bool is_record = std::string_view(text).starts_with(magic);
  const std::string json_text = is_record ? record_as_json(path) : text;
  try {
    return parse(json_text);
  } catch (const std::exception& error) {  // ours, and of the JSON library
    throw ToolError(path.string() + ": not a result of `roomcal calibrate --json`, nor a record: " + error.what());
  }
}

}  // namespace roomcal::tools
