#include "tools/device/device.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "runtime/base/fixed_text.h"
#include "runtime/base/names.h"
#include "runtime/camera/camera.h"
#include "runtime/store/record.h"
#include "tools/common/error.h"

namespace roomcal::tools {

namespace {

constexpr std::size_t kMaxName = SensorName::capacity();
constexpr std::size_t kMaxSensors = 64;  // far above any device; a list beyond is a damaged file
constexpr double kMaxLever_m = 100;      // no rig is larger
constexpr double kIdentitySlack = 1e-9;

bool is_short_name(const std::string& name) { return name.size() <= kMaxName && is_name(name); }

void check_serial(const std::string& serial, const std::string& where) {
  if (serial.size() > store::Serial::capacity() || !is_printable(serial))
    throw ToolError(
        fmt::format("{}: serial `{}`; use at most {} characters of ASCII", where, serial, store::Serial::capacity()));
}

bool is_identity(const SE3& T) {
  return (T.R - Mat33::Identity()).norm() < kIdentitySlack && T.t.norm() < kIdentitySlack;
}

void check_nominal(const NominalMount& nominal, const std::string& where) {
  if (!nominal.T_rig_sensor.R.allFinite() || !nominal.T_rig_sensor.t.allFinite()) {
    throw ToolError(where + ": the nominal mount is not finite");
  }
  if (!(nominal.T_rig_sensor.t.norm() <= kMaxLever_m)) {
    throw ToolError(fmt::format("{}: the nominal mount is more than {} m from the rig frame; translations are metres",
                                where, kMaxLever_m));
  }
  if (!(nominal.sigma_t_m > 0 && nominal.sigma_t_m <= 10)) {
    throw ToolError(where + ": sigma_t_m must be between 0 and 10 m; how far off may the mounting be?");
  }
  if (!(nominal.sigma_rot_rad > 0 && nominal.sigma_rot_rad <= kPi)) {
    throw ToolError(where + ": sigma_rot_deg must be between 0 and 180; how far off may the mounting be?");
  }
}

}  // namespace

const Sensor* Device::find(const std::string& sensor) const {
  const auto found = std::find_if(sensors.begin(), sensors.end(), [&](const Sensor& s) { return s.name == sensor; });
  return found == sensors.end() ? nullptr : &*found;
}

void check_device(const Device& device, const std::string& where) {
  if (device.sensors.empty()) throw ToolError(where + ": no sensors; a device has one at least");
  if (device.sensors.size() > kMaxSensors) throw ToolError(fmt::format("{}: more than {} sensors", where, kMaxSensors));
  check_serial(device.serial, where);
  std::set<std::string> names;
  for (const Sensor& sensor : device.sensors) {
    if (!is_short_name(sensor.name)) {
      throw ToolError(fmt::format("{}: sensor name `{}`; use 1 to {} letters, digits, `_`, `-`, `.`", where,
                                  sensor.name, kMaxName));
    }
    const std::string here = where + ": " + sensor.name;
    if (!names.insert(sensor.name).second) throw ToolError(here + ": two sensors have this name; rename one");
    if (sensor.kind == SensorKind::kCamera) require(camera::Camera::create(sensor.intrinsics).status(), here);
    if (sensor.nominal) check_nominal(*sensor.nominal, here);
    check_serial(sensor.serial, here);
  }
  const Sensor* rig = device.find(device.rig_frame);
  if (rig == nullptr)
    throw ToolError(fmt::format("{}: rig_frame `{}` is none of the sensors", where, device.rig_frame));
  if (rig->nominal && !is_identity(rig->nominal->T_rig_sensor)) {
    throw ToolError(
        fmt::format("{}: {} is the rig frame; its T_rig_sensor must be the identity, or left out", where, rig->name));
  }
}

std::string to_string(camera::Model model) {
  return model == camera::Model::kPinholeRadtan ? "pinhole_radtan" : "kannala_brandt";
}

}  // namespace roomcal::tools
