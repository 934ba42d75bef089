#include <cmath>
#include <string_view>

#include <Eigen/LU>

#include "runtime/base/reason.h"
#include "runtime/calib/lidar_models.h"
#include "runtime/grab/sweep_tray.h"
#include "runtime/profile/profile.h"

namespace roomcal::profile {

namespace {

constexpr double kMaxLever_m = 100;

Status refuse(const Reason& why, Reason& what) {
  what = why;
  return {StatusCode::kInvalidArgument, "the profile cannot work"};
}

bool printable(std::string_view text) {
  for (const char c : text)
    if (c <= ' ' || c > '~') return false;
  return !text.empty();
}

bool is_rotation(const Mat33& R) {
  return R.allFinite() && (R * R.transpose() - Mat33::Identity()).norm() < 1e-6 && R.determinant() > 0;
}

bool sane(const calib::NominalMounting& nominal) {
  if (!nominal.known) return true;
  return is_rotation(nominal.T_rig_sensor.R) && nominal.T_rig_sensor.t.norm() < kMaxLever_m && nominal.sigma_t_m > 0 &&
         nominal.sigma_t_m <= 10 && nominal.sigma_rot_rad > 0 && nominal.sigma_rot_rad <= kPi;
}

bool in(double value, double least, double most) { return value >= least && value <= most; }

Status check_camera(const CameraProfile& camera, Reason& what) {
  const Name who(camera.name);
  const CameraWiring& w = camera.wiring;
  if (!camera::Camera::create(camera.intrinsics).ok())
    return refuse(make_reason("%.*s: its intrinsics are none", who.length, who.text), what);
  if (!in(camera.sigma_px, 0, 5))
    return refuse(make_reason("%.*s: sigma_px is not between 0 and 5", who.length, who.text), what);
  if (w.driver != ImageDriver::kReplay && w.key.empty())
    return refuse(make_reason("%.*s: its driver has no key to find it by", who.length, who.text), what);
  if (!in(w.rate_hz, 0, 1000) || !in(w.exposure_us, 0, 60e6) || !in(w.gain, -1, 1e6) || w.buffers < 2 || w.buffers > 16)
    return refuse(
        make_reason("%.*s: rate, exposure, gain or buffers of its driver are out of range", who.length, who.text),
        what);
  return ok_status();
}

Status check_lidar(const Profile& profile, const LidarProfile& lidar, Reason& what) {
  const Name who(lidar.name);
  const lidar::ModelInfo* model = calib::packets_of(lidar.model.view());
  if (model == nullptr || calib::ranges_of(lidar.model.view()) == nullptr || lidar.calibration.model != model->model)
    return refuse(make_reason("%.*s: its model is not known", who.length, who.text), what);
  if (lidar.wiring.sweeps < 1 || lidar.wiring.sweeps > grab::kMaxTraySweeps)
    return refuse(make_reason("%.*s: a shot joins one to %zu sweeps", who.length, who.text, grab::kMaxTraySweeps),
                  what);
  if (lidar.on_turntable && profile.wiring.servo.node == 0)
    return refuse(make_reason("%.*s: it is on a turntable, and wiring.servo names no node", who.length, who.text),
                  what);
  if (lidar.on_turntable &&
      (std::abs(lidar.turntable.axis_lidar.norm() - 1) > 1e-6 || !is_rotation(lidar.turntable.T_lidar_profiler.R)))
    return refuse(make_reason("%.*s: the turntable's axis or mounting is none", who.length, who.text), what);
  if (!lidar.wiring.group.empty() && lidar.wiring.interface.empty())
    return refuse(make_reason("%.*s: a multicast group needs the network interface", who.length, who.text), what);
  return ok_status();
}

/// Name, serial and mounting of one sensor against those before it.
template <typename Sensor>
Status check_identity(const Profile& profile, const Sensor& sensor, Reason& what) {
  const Name who(sensor.name);
  if (!printable(sensor.name.view())) return refuse("a sensor has no printable name", what);
  if (!sane(sensor.nominal))
    return refuse(make_reason("%.*s: its nominal mounting is no mounting", who.length, who.text), what);
  std::size_t names = 0, serials = 0;
  const auto count = [&](const auto& other) {
    names += other.name.view() == sensor.name.view() ? 1 : 0;
    serials += !sensor.serial.empty() && other.serial.view() == sensor.serial.view() ? 1 : 0;
  };
  for (const CameraProfile& camera : profile.cameras) count(camera);
  for (const LidarProfile& lidar : profile.lidars) count(lidar);
  if (names > 1) return refuse(make_reason("%.*s: two sensors have this name", who.length, who.text), what);
  if (serials > 1)
    return refuse(make_reason("%.*s: another sensor has its serial: read it off both", who.length, who.text), what);
  return ok_status();
}

Status check_wiring(const Wiring& w, Reason& what) {
  if (w.store.page_bytes != 0 && (w.store.page_bytes & (w.store.page_bytes - 1)) != 0)
    return refuse("store: its page size is not a power of two", what);
  if (w.store.kind == StoreKind::kFile && (w.store.size_bytes < 1024 || w.store.size_bytes > (64U << 20)))
    return refuse("store: a file takes 1 KiB to 64 MiB", what);
  if (w.trigger.kind == TriggerKind::kLine && w.trigger.line.empty()) return refuse("trigger: it has no line", what);
  if (w.trigger.kind == TriggerKind::kAction && w.trigger.address.empty())
    return refuse("trigger: an action command needs an address", what);
  if (w.trigger.kind == TriggerKind::kCan && w.can.interface.empty())
    return refuse("trigger: over CAN needs wiring.can.interface", what);
  if (w.button.kind == ButtonKind::kEvdev && (w.button.path.empty() || w.button.code == 0 || w.button.code > 0x2ff))
    return refuse("button: an input device needs its path and the key's code", what);
  if (w.button.kind == ButtonKind::kLine && w.button.line.empty()) return refuse("button: it has no line", what);
  if (w.light.kind == LightKind::kLed && w.light.path.empty()) return refuse("light: it has no path", what);
  if (w.light.kind == LightKind::kLine && w.light.line.empty()) return refuse("light: it has no line", what);
  if (w.can.standstill && w.can.interface.empty()) return refuse("can: standstill needs an interface", what);
  if (w.servo.node != 0 && w.can.interface.empty()) return refuse("servo: it needs wiring.can.interface", what);
  if (w.servo.node > 127 || !in(std::abs(w.servo.counts_per_turn), 1, 1e9) || !in(w.servo.half_turn_s, 0.5, 600) ||
      !(std::abs(w.servo.velocity_units_per_count) > 0) || !(w.servo.acceleration_units_per_count > 0))
    return refuse("servo: node, units or time of a turn are out of range", what);
  if (!w.watchdog.path.empty() && (w.watchdog.timeout_s < 2 || w.watchdog.timeout_s > 600))
    return refuse("watchdog: its timeout is not between 2 and 600 s", what);
  return ok_status();
}

}  // namespace

Status check_profile(const Profile& profile, Reason& what) {
  what.clear();
  if (profile.cameras.empty()) return refuse("a device has one camera at least", what);
  if (profile.reference >= profile.cameras.size())
    return refuse("the reference sensor is not one of the cameras", what);
  for (const CameraProfile& camera : profile.cameras) {
    ROOMCAL_TRY(check_identity(profile, camera, what));
    ROOMCAL_TRY(check_camera(camera, what));
  }
  for (const LidarProfile& lidar : profile.lidars) {
    ROOMCAL_TRY(check_identity(profile, lidar, what));
    ROOMCAL_TRY(check_lidar(profile, lidar, what));
  }
  const GrabWiring& g = profile.grab;
  if (!in(g.patience_s, 0.5, 600) || !in(g.image_wait_s, 0.05, 120) || !in(g.max_spread_ms, 0, 10'000) ||
      !in(g.still_px, 0.01, 100))
    return refuse("grab: a time or limit is out of range", what);
  return check_wiring(profile.wiring, what);
}

}  // namespace roomcal::profile
