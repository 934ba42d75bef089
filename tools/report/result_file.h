#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "runtime/camera/camera.h"
#include "runtime/math/se3.h"
#include "runtime/scan/sensor_model.h"

namespace roomcal::tools {

/// What a result knows of a LiDAR beside its place.
struct LidarResult {
  std::string model;
  std::string file;        ///< in the shot's folder; empty: named after the sensor
  std::size_t sweeps = 0;  ///< that took part
  double sigma_m = 0;      ///< of one range, as used; 0: not told
  std::array<double, scan::kMaxBeams> beam_offset_m{};
};

/// One sensor of a result; what is not there was not told, or the sensor was not located.
struct SensorResult {
  std::string name;
  std::optional<SE3> T_room_sensor;
  std::optional<SE3> T_rig_sensor;
  Mat66 cov_rig_sensor = Mat66::Zero();  ///< of T_rig_sensor, right perturbation (m, rad)
  std::optional<camera::Camera> camera;  ///< a camera
  std::optional<LidarResult> lidar;      ///< a LiDAR
};

/// A calibration, however it was written down.
struct ResultFile {
  nlohmann::json json;  ///< all of it: `roomcal calibrate --json`, or a record as `roomcal export --format json` has it
  std::string rig_frame;  ///< name of the reference sensor
  std::vector<SensorResult> sensors;

  /// @return nullptr if there is none of that name.
  const SensorResult* find(const std::string& name) const;
};

/// A result of `roomcal calibrate --json` whatever its verdict, a record, or a record exported as JSON.
/// @throws ToolError naming the file and why it is none of them.
ResultFile read_result(const std::filesystem::path& path);

}  // namespace roomcal::tools
