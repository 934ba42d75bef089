#include <Eigen/LU>

#include "runtime/base/names.h"
#include "runtime/base/reason.h"
#include "runtime/calib/lidar_models.h"
#include "runtime/calib/limit_table.h"
#include "runtime/profile/profile.h"
#include "runtime/profile/wiring_check.h"

namespace roomcal::profile {

namespace {

constexpr double kMaxLever_m = 100;  // no rig is larger
constexpr double kSlack = 1e-6;      // of a rotation, and of the reference's own mounting

Reason about(const SensorName& sensor, const char* what) {
  const Name who(sensor);
  return make_reason("%.*s: %s", who.length, who.text, what);
}

bool is_pose(const SE3& T) {
  return T.R.allFinite() && (T.R * T.R.transpose() - Mat33::Identity()).norm() < kSlack && T.R.determinant() > 0 &&
         is_within(T.t.norm(), 0, kMaxLever_m);
}

bool is_mounting(const calib::NominalMounting& nominal) {
  return !nominal.known || (is_pose(nominal.T_rig_sensor) && nominal.sigma_t_m > 0 && nominal.sigma_t_m <= 10 &&
                            nominal.sigma_rot_rad > 0 && nominal.sigma_rot_rad <= kPi);
}

bool is_identity(const SE3& T) { return (T.R - Mat33::Identity()).norm() < kSlack && T.t.norm() < kSlack; }

/// Name, serial and mounting of one sensor among all.
template <typename Sensor>
Reason identity_complaint(const Profile& profile, const Sensor& sensor, const char* kind, std::size_t number) {
  if (!is_name(sensor.name.view()))
    return make_reason("%s %zu: its name is not of letters, digits, _ - .", kind, number);
  if (!is_printable(sensor.serial.view())) return about(sensor.name, "its serial is not of printable characters");
  if (!is_mounting(sensor.nominal))
    return about(sensor.name, "its nominal mounting is none: a rotation, at most 100 m, sigmas above 0");
  std::size_t names = 0, serials = 0;
  const auto count = [&](const auto& other) {
    names += other.name.view() == sensor.name.view() ? 1 : 0;
    serials += !sensor.serial.empty() && other.serial.view() == sensor.serial.view() ? 1 : 0;
  };
  for (const CameraProfile& camera : profile.cameras) count(camera);
  for (const LidarProfile& lidar : profile.lidars) count(lidar);
  if (names > 1) return about(sensor.name, "two sensors have this name: rename one");
  if (serials > 1) return about(sensor.name, "another sensor has its serial: read it off both");
  return {};
}

Reason camera_complaint(const Profile& profile, std::size_t i) {
  const CameraProfile& camera = profile.cameras[i];
  if (const Reason who = identity_complaint(profile, camera, "camera", i); !who.empty()) return who;
  if (i == profile.reference && camera.nominal.known && !is_identity(camera.nominal.T_rig_sensor))
    return about(camera.name, "it is the reference: its nominal mounting is the identity, or left out");
  if (!camera::Camera::create(camera.intrinsics).ok())
    return about(camera.name, "its intrinsics are none: import them again");
  if (!is_within(camera.sigma_px, 0, 5)) return about(camera.name, "sigma_px is not between 0 and 5");
  return wiring_complaint(camera);
}

/// One servo turns one profiler.
Reason turntable_complaint(const Profile& profile, std::size_t i) {
  const LidarProfile& lidar = profile.lidars[i];
  if (!lidar.on_turntable) return {};
  if (profile.wiring.servo.node == 0) return about(lidar.name, "it is on a turntable: give wiring.servo its node");
  if (lidar.calibration.beam_count != 1) return about(lidar.name, "only a 2-D profiler sits on a turntable");
  if (!is_within(lidar.turntable.axis_lidar.norm(), 1 - kSlack, 1 + kSlack) ||
      !is_pose(lidar.turntable.T_lidar_profiler))
    return about(lidar.name, "its turntable is none: a unit axis, a rotation, at most 100 m");
  for (std::size_t k = 0; k < i; ++k)
    if (profile.lidars[k].on_turntable) return about(lidar.name, "another LiDAR is on the turntable already");
  return {};
}

Reason lidar_complaint(const Profile& profile, std::size_t i) {
  const LidarProfile& lidar = profile.lidars[i];
  if (const Reason who = identity_complaint(profile, lidar, "LiDAR", i); !who.empty()) return who;
  const lidar::ModelInfo* model = calib::packets_of(lidar.model.view());
  if (model == nullptr || calib::ranges_of(lidar.model.view()) == nullptr)
    return about(lidar.name, "its model is not known: `roomcal sweep --help` lists them");
  if (lidar.calibration.model != model->model) return about(lidar.name, "its angles are of another model");
  if (const Reason table = turntable_complaint(profile, i); !table.empty()) return table;
  return wiring_complaint(lidar);
}

Reason limit_complaint(const calib::Limits& limits) {
  for (const calib::LimitField& field : calib::limit_table()) {
    calib::Limits scratch;
    if (!set_limit(scratch, field, get_limit(limits, field)))
      return make_reason("limits: %.*s is not between %g and %g", static_cast<int>(field.name.size()),
                         field.name.data(), field.least, field.most);
  }
  return {};
}

Reason grab_complaint(const GrabWiring& grab) {
  if (!is_within(grab.patience_s, 0.5, 600)) return "grab: patience_s is not between 0.5 and 600";
  if (!is_within(grab.image_wait_s, 0.05, 120)) return "grab: image_wait_s is not between 0.05 and 120";
  if (!is_within(grab.max_spread_ms, 0, 10'000)) return "grab: max_spread_ms is not between 0 and 10000";
  if (!is_within(grab.still_px, 0.01, 100)) return "grab: still_px is not between 0.01 and 100";
  return {};
}

Reason sensor_complaint(const Profile& profile) {
  for (std::size_t i = 0; i < profile.cameras.size(); ++i)
    if (const Reason what = camera_complaint(profile, i); !what.empty()) return what;
  for (std::size_t i = 0; i < profile.lidars.size(); ++i)
    if (const Reason what = lidar_complaint(profile, i); !what.empty()) return what;
  return sharing_complaint(profile);
}

Reason complaint(const Profile& profile) {
  if (profile.device.empty() || !is_printable(profile.device.view()) || !is_printable(profile.serial.view()))
    return "device: its name is empty, or name or serial are not of printable characters";
  if (profile.cameras.empty()) return "device: it has no camera; one at least is the reference";
  if (profile.reference >= profile.cameras.size()) return "device: the reference sensor is not one of the cameras";
  for (const Reason& part : {sensor_complaint(profile), limit_complaint(profile.limits), grab_complaint(profile.grab),
                             wiring_complaint(profile.wiring)})
    if (!part.empty()) return part;
  return {};
}

}  // namespace

Status check_profile(const Profile& profile, Reason& what) {
  what = complaint(profile);
  return what.empty() ? ok_status() : Status(StatusCode::kInvalidArgument, "the profile cannot work");
}

}  // namespace roomcal::profile
