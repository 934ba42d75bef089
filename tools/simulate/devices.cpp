#include "tools/simulate/devices.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

camera::Intrinsics lens(camera::Model model, int width, int height, double f,
                        const std::array<double, camera::kDistortionCount>& distortion) {
  return {model, width, height, f, f, (width - 1) / 2.0, (height - 1) / 2.0, distortion};
}

std::vector<DeviceCamera> cameras(int count, const camera::Intrinsics& nominal) {
  std::vector<DeviceCamera> all;
  for (int i = 0; i < count; ++i) all.push_back({fmt::format("cam{}", i), nominal});
  return all;
}

constexpr auto kRadtan = camera::Model::kPinholeRadtan;
constexpr auto kFisheye = camera::Model::kKannalaBrandt;

std::vector<PaperDevice> make_devices() {
  std::vector<PaperDevice> devices(4);
  devices[0] = {"stereo_rig", cameras(2, lens(kRadtan, 1280, 1024, 1745, {-0.11, 0.12, 4e-4, -3e-4})),
                {},           {{"cam1", "cam0", {0, 0, 0}, {-0.12, 0, 0}}},
                1.3,          -8,
                true};
  devices[1] = {"mobile_robot",
                cameras(4, lens(kFisheye, 1280, 720, 614, {-0.02, 0.005, -0.002, 4e-4})),
                {{"lidar0", "vlp16"}},
                {{"cam1", "cam0", {0, 90, 0}, {0.0565, 0, 0.0565}},
                 {"cam2", "cam0", {0, 180, 0}, {0, 0, -0.1129}},
                 {"cam3", "cam0", {0, -90, 0}, {-0.0565, 0, -0.0565}},
                 {"lidar0", "cam0", {90, -45, 0}, {0, -0.0593, -0.0549}}},
                0.8,
                -2,
                false};
  devices[2] = {"backpack",
                cameras(4, lens(kFisheye, 2304, 3840, 1430, {-0.011, 0.0037, -0.0015, 2e-4})),
                {{"lidar0", "vlp16"}, {"lidar1", "vlp16"}},
                {{"cam1", "cam0", {0, -90, 0}, {-0.0312, 0, -0.0212}},
                 {"cam2", "cam0", {0, -180, 0}, {0, 0, -0.0623}},
                 {"cam3", "cam0", {0, 90, 0}, {0.0312, 0, -0.0312}},
                 {"lidar0", "cam0", {0, -15, 90}, {0.6138, 0, -0.0381}},
                 {"lidar1", "lidar0", {0, -75, -30}, {-0.2255, 0.1302, -0.3492}}},
                1.7,
                -2,
                false};
  devices[3] = {"tls",
                cameras(2, lens(kRadtan, 4608, 3456, 3360, {-0.08, 0.055, 3e-4, -2e-4})),
                {{"lidar0", "tls"}},
                {{"cam1", "cam0", {28, 0, 0}, {0, 0.028, 0}}, {"lidar0", "cam0", {-14, 0, 0}, {0, -0.014, 0.02}}},
                1.45,
                0,
                true};
  return devices;
}

}  // namespace

SE3 MountingEdge::T_to_from() const {
  const Mat33 R = so3_exp(deg_to_rad(euler_xyz_deg.z()) * Vec3::UnitZ()) *
                  so3_exp(deg_to_rad(euler_xyz_deg.y()) * Vec3::UnitY()) *
                  so3_exp(deg_to_rad(euler_xyz_deg.x()) * Vec3::UnitX());
  return {R, t_m};
}

const std::vector<PaperDevice>& known_devices() {
  static const std::vector<PaperDevice> devices = make_devices();
  return devices;
}

std::string device_names() {
  std::vector<std::string> names;
  for (const PaperDevice& device : known_devices()) names.push_back(device.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

const PaperDevice& device_named(const std::string& name) {
  for (const PaperDevice& device : known_devices())
    if (device.name == name) return device;
  throw ToolError(fmt::format("--device {}: unknown; take one of {}", name, device_names()));
}

PaperDevice with_lidars(PaperDevice device, const std::string& unit) {
  if (unit.empty()) return device;
  bool any = false;
  for (DeviceLidar& lidar : device.lidars) {
    if (lidar.unit == kTlsKind) continue;
    lidar.unit = unit;
    any = true;
  }
  if (!any) throw ToolError(fmt::format("--lidar {}: {} has no spinning LiDAR; leave it out", unit, device.name));
  return device;
}

PaperDevice scaled(PaperDevice device, double scale) {
  for (DeviceCamera& camera : device.cameras) {
    camera::Intrinsics& lens = camera.nominal;
    const double across = lens.width_px, down = lens.height_px;
    lens.width_px = std::max(1, static_cast<int>(std::lround(scale * across)));
    lens.height_px = std::max(1, static_cast<int>(std::lround(scale * down)));
    lens.fx_px *= lens.width_px / across;
    lens.fy_px *= lens.height_px / down;
    lens.cx_px = (lens.cx_px + 0.5) * lens.width_px / across - 0.5;  // pixel 0 begins at -0.5
    lens.cy_px = (lens.cy_px + 0.5) * lens.height_px / down - 0.5;
  }
  return device;
}

}  // namespace roomcal::tools
