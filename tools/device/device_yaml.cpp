#include "tools/device/device_yaml.h"

#include <algorithm>

#include <fmt/format.h>

#include "tools/common/files.h"
#include "tools/common/yaml.h"
#include "tools/device/limits_yaml.h"
#include "tools/device/wiring_yaml.h"

namespace roomcal::tools {

namespace {

constexpr int kVersion = 1;

class DeviceReader {
 public:
  explicit DeviceReader(const YamlText& yaml) : yaml_(yaml) {}

  Device read() const {
    const YAML::Node& root = yaml_.root();
    yaml_.allow_keys(root, {"version", "name", "serial", "rig_frame", "sensors", "limits", "grab", "wiring"}, "device");
    const YAML::Node version = yaml_.field(root, "version");
    if (yaml_.whole_number(version, "version") != kVersion) {
      yaml_.fail(version, fmt::format("version: this roomcal reads version {}", kVersion));
    }
    Device device;
    device.name = yaml_.text(yaml_.field(root, "name"), "name");
    device.rig_frame = yaml_.text(yaml_.field(root, "rig_frame"), "rig_frame");
    const YAML::Node sensors = yaml_.field(root, "sensors");
    if (!sensors.IsSequence()) yaml_.fail(sensors, "sensors: expected a list, `- name: cam0` and so on");
    for (const auto& sensor : sensors) device.sensors.push_back(read_sensor(sensor));
    if (root["serial"].IsDefined()) device.serial = yaml_.text(root["serial"], "serial");
    if (root["limits"].IsDefined()) device.limits = read_limits(yaml_, root["limits"]);
    if (root["grab"].IsDefined()) device.grab = read_grab(yaml_, root["grab"]);
    if (root["wiring"].IsDefined()) device.wiring = read_wiring(yaml_, root["wiring"]);
    return device;
  }

 private:
  Sensor read_sensor(const YAML::Node& node) const {
    Sensor sensor;
    sensor.name = yaml_.text(yaml_.field(node, "name"), "sensor name");
    const YAML::Node kind = yaml_.field(node, "kind");
    const std::string kind_text = yaml_.text(kind, sensor.name + ": kind");
    if (kind_text == "camera") {
      read_camera(node, sensor);
    } else if (kind_text == "lidar") {
      read_lidar(node, sensor);
    } else {
      yaml_.fail(kind, fmt::format("{}: kind `{}`; known are camera and lidar", sensor.name, kind_text));
    }
    if (node["serial"].IsDefined()) sensor.serial = yaml_.text(node["serial"], sensor.name + ": serial");
    if (node["nominal"].IsDefined()) sensor.nominal = read_nominal(node["nominal"], sensor.name + ": nominal");
    return sensor;
  }

  void read_camera(const YAML::Node& node, Sensor& sensor) const {
    yaml_.allow_keys(node,
                     {"name", "kind", "serial", "model", "resolution_px", "intrinsics_px", "distortion", "sigma_px",
                      "intrinsics_sigma", "nominal", "driver"},
                     sensor.name);
    camera::Intrinsics& intrinsics = sensor.intrinsics;
    const YAML::Node model = yaml_.field(node, "model");
    const std::string model_text = yaml_.text(model, sensor.name + ": model");
    if (model_text == to_string(camera::Model::kKannalaBrandt)) {
      intrinsics.model = camera::Model::kKannalaBrandt;
    } else if (model_text != to_string(camera::Model::kPinholeRadtan)) {
      yaml_.fail(model, fmt::format("{}: model `{}` is not supported; known are pinhole_radtan and kannala_brandt",
                                    sensor.name, model_text));
    }
    const YAML::Node size = yaml_.field(node, "resolution_px");
    yaml_.numbers(size, 2, sensor.name + ": resolution_px");
    intrinsics.width_px = yaml_.whole_number(size[0], sensor.name + ": resolution_px");
    intrinsics.height_px = yaml_.whole_number(size[1], sensor.name + ": resolution_px");
    const auto f = yaml_.numbers(yaml_.field(node, "intrinsics_px"), 4, sensor.name + ": intrinsics_px");
    intrinsics.fx_px = f[0];
    intrinsics.fy_px = f[1];
    intrinsics.cx_px = f[2];
    intrinsics.cy_px = f[3];
    const auto d =
        yaml_.numbers(yaml_.field(node, "distortion"), camera::kDistortionCount, sensor.name + ": distortion");
    std::copy(d.begin(), d.end(), intrinsics.distortion.begin());
    if (const YAML::Node sigma = node["sigma_px"]; sigma.IsDefined()) {
      sensor.sigma_px = yaml_.number(sigma, sensor.name + ": sigma_px");
      if (!(sensor.sigma_px >= 0 && sensor.sigma_px <= 5))
        yaml_.fail(sigma, sensor.name + ": sigma_px is what the intrinsics leave, between 0 and 5 px");
    }
    if (node["driver"].IsDefined())
      sensor.camera_wiring = read_camera_wiring(yaml_, node["driver"], sensor.name + ": driver");
    if (node["intrinsics_sigma"].IsDefined())
      sensor.intrinsics_sigma = read_sigma(node["intrinsics_sigma"], sensor.name + ": intrinsics_sigma", intrinsics);
  }

  camera::IntrinsicsSigma read_sigma(const YAML::Node& node, const std::string& what,
                                     const camera::Intrinsics& intrinsics) const {
    yaml_.allow_keys(node, {"focal_px", "principal_px", "distortion_px"}, what);
    camera::IntrinsicsSigma sigma = camera::usual_sigma(intrinsics);
    const auto read = [&](const char* key, double most_px, double& into) {
      const YAML::Node value = node[key];
      if (!value.IsDefined()) return;
      into = yaml_.number(value, what + ": " + key);
      if (!(into >= 0 && into <= most_px))
        yaml_.fail(value, fmt::format("{}: {} must be between 0 and {:.0f} px", what, key, most_px));
    };
    read("focal_px", 0.05 * intrinsics.fx_px, sigma.focal_px);
    read("principal_px", 0.05 * intrinsics.width_px, sigma.principal_px);
    read("distortion_px", 0.05 * intrinsics.width_px, sigma.distortion_px);
    return sigma;
  }

  void read_lidar(const YAML::Node& node, Sensor& sensor) const {
    yaml_.allow_keys(node, {"name", "kind", "serial", "model", "file", "calibration", "nominal", "driver", "turntable"},
                     sensor.name);
    sensor.kind = SensorKind::kLidar;
    sensor.lidar_model = yaml_.text(yaml_.field(node, "model"), sensor.name + ": model");
    if (node["file"].IsDefined()) sensor.file = yaml_.text(node["file"], sensor.name + ": file");
    if (node["turntable"].IsDefined())
      sensor.turntable = read_turntable(node["turntable"], sensor.name + ": turntable");
    if (node["calibration"].IsDefined())
      sensor.calibration_file = yaml_.text(node["calibration"], sensor.name + ": calibration");
    if (node["driver"].IsDefined())
      sensor.lidar_wiring = read_lidar_wiring(yaml_, node["driver"], sensor.name + ": driver");
  }

  lidar::TurntableMounting read_turntable(const YAML::Node& node, const std::string& what) const {
    yaml_.allow_keys(node, {"axis_lidar", "T_lidar_profiler"}, what);
    lidar::TurntableMounting table;
    const auto axis = yaml_.numbers(yaml_.field(node, "axis_lidar"), 3, what + ": axis_lidar");
    table.axis_lidar = Vec3(axis[0], axis[1], axis[2]);
    if (std::abs(table.axis_lidar.norm() - 1) > 1e-3) yaml_.fail(node, what + ": axis_lidar is a unit vector");
    table.axis_lidar.normalize();
    table.T_lidar_profiler =
        SE3::from_matrix(yaml_.transform(yaml_.field(node, "T_lidar_profiler"), what + ": T_lidar_profiler"));
    return table;
  }

  NominalMount read_nominal(const YAML::Node& node, const std::string& what) const {
    yaml_.allow_keys(node, {"T_rig_sensor", "sigma_t_m", "sigma_rot_deg"}, what);
    NominalMount nominal;
    nominal.T_rig_sensor =
        SE3::from_matrix(yaml_.transform(yaml_.field(node, "T_rig_sensor"), what + ": T_rig_sensor"));
    nominal.sigma_t_m = yaml_.number(yaml_.field(node, "sigma_t_m"), what + ": sigma_t_m");
    nominal.sigma_rot_rad = deg_to_rad(yaml_.number(yaml_.field(node, "sigma_rot_deg"), what + ": sigma_rot_deg"));
    return nominal;
  }

  const YamlText& yaml_;
};

std::string rows_text(const SE3& pose) {
  std::string text;
  const Mat44 T = pose.matrix();
  for (int row = 0; row < 4; ++row)
    text += fmt::format("        - [{}, {}, {}, {}]\n", T(row, 0), T(row, 1), T(row, 2), T(row, 3));
  return text;
}

std::string turntable_text(const lidar::TurntableMounting& table) {
  const Vec3& axis = table.axis_lidar;
  return fmt::format("    turntable:\n      axis_lidar: [{}, {}, {}]\n      T_lidar_profiler:\n", axis.x(), axis.y(),
                     axis.z()) +
         rows_text(table.T_lidar_profiler);
}

std::string nominal_text(const NominalMount& nominal) {
  const std::string text = "    nominal:\n      T_rig_sensor:\n" + rows_text(nominal.T_rig_sensor);
  return text + fmt::format("      sigma_t_m: {}\n      sigma_rot_deg: {}\n", nominal.sigma_t_m,
                            rad_to_deg(nominal.sigma_rot_rad));
}

std::string sensor_text(const Sensor& sensor) {
  std::string text = "  - name: " + yaml_quoted(sensor.name) + "\n";
  if (!sensor.serial.empty()) text += "    serial: " + yaml_quoted(sensor.serial) + "\n";
  const bool is_camera = sensor.kind == SensorKind::kCamera;
  const std::string driver = is_camera ? to_text(sensor.camera_wiring) : to_text(sensor.lidar_wiring);
  if (is_camera) {
    const camera::Intrinsics& i = sensor.intrinsics;
    text += fmt::format("    kind: camera\n    model: {}\n    resolution_px: [{}, {}]\n", to_string(i.model),
                        i.width_px, i.height_px);
    text += fmt::format("    intrinsics_px: [{}, {}, {}, {}]\n", i.fx_px, i.fy_px, i.cx_px, i.cy_px);
    text += fmt::format("    distortion: [{}]\n", fmt::join(i.distortion, ", "));
    if (sensor.sigma_px > 0) text += fmt::format("    sigma_px: {}\n", sensor.sigma_px);
    if (const auto& sigma = sensor.intrinsics_sigma)
      text += fmt::format("    intrinsics_sigma: {{focal_px: {}, principal_px: {}, distortion_px: {}}}\n",
                          sigma->focal_px, sigma->principal_px, sigma->distortion_px);
  } else {
    text += "    kind: lidar\n    model: " + yaml_quoted(sensor.lidar_model) + "\n";
    if (!sensor.file.empty()) text += "    file: " + yaml_quoted(sensor.file) + "\n";
    if (!sensor.calibration_file.empty()) text += "    calibration: " + yaml_quoted(sensor.calibration_file) + "\n";
  }
  if (sensor.turntable) text += turntable_text(*sensor.turntable);
  if (!driver.empty()) text += "    driver: " + driver + "\n";
  return sensor.nominal ? text + nominal_text(*sensor.nominal) : text;
}

}  // namespace

Device parse_device_yaml(const std::string& where, const std::string& text) {
  const YamlText yaml(where, text);
  Device device = DeviceReader(yaml).read();
  check_device(device, where);
  return device;
}

std::string to_device_yaml(const Device& device) {
  std::string text = fmt::format(
      "# Made by roomcal; T_rig_sensor maps points of the sensor to the rig frame, metres.\nversion: {}\n", kVersion);
  text += "name: " + yaml_quoted(device.name) +
          (device.serial.empty() ? "" : "\nserial: " + yaml_quoted(device.serial)) +
          "\nrig_frame: " + yaml_quoted(device.rig_frame) + "\nsensors:\n";
  for (const Sensor& sensor : device.sensors) text += sensor_text(sensor);
  if (const std::string grab = to_text(device.grab); !grab.empty()) text += "grab: " + grab + "\n";
  return text + limits_text(device.limits) + wiring_text(device.wiring);
}

Device read_device(const std::filesystem::path& path) { return parse_device_yaml(path.string(), read_text(path)); }

}  // namespace roomcal::tools
