#include "tools/device/kalibr.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tools/common/yaml.h"

namespace roomcal::tools {

namespace {

constexpr const char* kRemedy = "calibrate with Kalibr's pinhole-radtan or pinhole-equi";

class KalibrReader {
 public:
  explicit KalibrReader(const YamlText& yaml) : yaml_(yaml) {}

  Device read() const {
    Device device;
    SE3 T_rig_before;
    bool chained = true;  // every camera so far has its T_cn_cnm1
    for (const auto& entry : yaml_.root()) {
      Sensor sensor = read_camera(yaml_.text(entry.first, "camera name"), entry.second);
      const bool first = device.sensors.empty();
      chained = first || (chained && entry.second["T_cn_cnm1"].IsDefined());
      if (!first && entry.second["T_cn_cnm1"].IsDefined()) {
        const Mat44 T = yaml_.transform(entry.second["T_cn_cnm1"], sensor.name + ": T_cn_cnm1");
        T_rig_before = T_rig_before * SE3::from_matrix(T).inverse();
        const double hops = std::sqrt(static_cast<double>(device.sensors.size()));
        if (chained) sensor.nominal = {T_rig_before, hops * kChainSigma_t_m, hops * kChainSigma_rot_rad};
      }
      device.sensors.push_back(std::move(sensor));
    }
    device.rig_frame = device.sensors.front().name;
    return device;
  }

 private:
  Sensor read_camera(const std::string& name, const YAML::Node& node) const {
    if (!node.IsMap()) yaml_.fail(node, name + ": expected the keys of a Kalibr camera; is this a camchain?");
    Sensor sensor;
    sensor.name = name;
    const YAML::Node model = yaml_.field(node, "camera_model");
    if (const std::string text = yaml_.text(model, name + ": camera_model"); text != "pinhole") {
      yaml_.fail(model, fmt::format("{}: camera_model `{}` is not supported; {}", name, text, kRemedy));
    }
    read_distortion(node, sensor);
    const YAML::Node size = yaml_.field(node, "resolution");
    yaml_.numbers(size, 2, name + ": resolution");
    sensor.intrinsics.width_px = yaml_.whole_number(size[0], name + ": resolution");
    sensor.intrinsics.height_px = yaml_.whole_number(size[1], name + ": resolution");
    const auto f = yaml_.numbers(yaml_.field(node, "intrinsics"), 4, name + ": intrinsics");
    sensor.intrinsics.fx_px = f[0];
    sensor.intrinsics.fy_px = f[1];
    sensor.intrinsics.cx_px = f[2];
    sensor.intrinsics.cy_px = f[3];
    return sensor;
  }

  void read_distortion(const YAML::Node& node, Sensor& sensor) const {
    const YAML::Node model = yaml_.field(node, "distortion_model");
    const std::string text = yaml_.text(model, sensor.name + ": distortion_model");
    if (text == "none") return;  // pinhole radial-tangential with zeros
    if (text == "equidistant") {
      sensor.intrinsics.model = camera::Model::kKannalaBrandt;
    } else if (text != "radtan") {
      yaml_.fail(model, fmt::format("{}: distortion_model `{}` is not supported; {}", sensor.name, text, kRemedy));
    }
    const auto d = yaml_.numbers(yaml_.field(node, "distortion_coeffs"), camera::kDistortionCount,
                                 sensor.name + ": distortion_coeffs");
    std::copy(d.begin(), d.end(), sensor.intrinsics.distortion.begin());
  }

  const YamlText& yaml_;
};

}  // namespace

Device parse_kalibr(const std::string& where, const std::string& text) {
  const YamlText yaml(where, text);
  if (yaml.root().size() == 0) yaml.fail(yaml.root(), "no cameras; is this a Kalibr camchain?");
  Device device = KalibrReader(yaml).read();
  device.name = "device";
  check_device(device, where);
  return device;
}

}  // namespace roomcal::tools
