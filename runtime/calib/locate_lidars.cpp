#include <Eigen/Cholesky>

#include "runtime/base/reason.h"
#include "runtime/calib/locate_sensors.h"
#include "runtime/calib/preflight.h"

namespace roomcal::calib {

namespace {

/// Of the horizon that a LiDAR must see, the share that must fit the room: people and furniture hide the rest.
constexpr double kFitting = 0.8;

Mat66 mounting_cov(const NominalMounting& mounting) {
  Vec6 variance;
  variance.head<3>().setConstant(mounting.sigma_t_m * mounting.sigma_t_m);
  variance.tail<3>().setConstant(mounting.sigma_rot_rad * mounting.sigma_rot_rad);
  return variance.asDiagonal();
}

/// Where the rig's frame is in the room, by the reference camera, or by another one and its mounting.
struct LocatedRig {
  bool known = false;
  SE3 T_room_rig;
  Mat66 cov = Mat66::Zero();
};

LocatedRig locate_rig(const Session& session, const Outcome& outcome) {
  const CameraOutcome& reference = outcome.cameras[outcome.reference];
  if (reference.located) return {true, reference.T_room_cam, reference.cov_room_cam};
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
    const CameraOutcome& camera = outcome.cameras[i];
    const NominalMounting& mounting = session.device.cameras[i].nominal;
    if (!camera.located || !mounting.known) continue;
    // T_room_rig exp(xi_rig) = T_room_cam exp(xi_cam) (T_rig_cam exp(xi_m))^-1: xi_rig = Ad(T_rig_cam) (xi_cam - xi_m).
    const Mat66 Ad = se3_adjoint(mounting.T_rig_sensor);
    return {true, camera.T_room_cam * mounting.T_rig_sensor.inverse(),
            Ad * (camera.cov_room_cam + mounting_cov(mounting)) * Ad.transpose()};
  }
  return {};
}

bool prior_of(const LocatedRig& rig, const NominalMounting& mounting, scan::PosePrior& prior) {
  if (!rig.known || !mounting.known) return false;
  const Mat66 Ad = se3_adjoint(mounting.T_rig_sensor.inverse());
  prior.T_room_lidar = rig.T_room_rig * mounting.T_rig_sensor;
  prior.cov = Ad * rig.cov * Ad.transpose() + mounting_cov(mounting);
  return prior.cov.llt().info() == Eigen::Success;
}

Reason disagreement(const SensorName& name, const scan::PosePrior& prior, const SE3& T_room_lidar) {
  const Vec6 off = se3_log(prior.T_room_lidar.inverse() * T_room_lidar);
  const Name who(name);
  return make_reason(
      "%.*s: its sweep puts it %.2f m and %.1f deg from where cameras and nominal mounting do: check its "
      "bracket, and that this is the map of this room",
      who.length, who.text, off.head<3>().norm(), rad_to_deg(off.tail<3>().norm()));
}

Reason refusal(const SensorName& name, const scan::Location& location) {
  const Name who(name);
  return make_reason("%.*s: %s", who.length, who.text, location.reason);
}

Status locate_one(const Session& session, std::size_t i, const Sweeps& sweeps, const LocatedRig& rig, Arenas& arenas,
                  LidarOutcome& lidar) {
  scan::PosePrior prior;
  lidar.had_prior = prior_of(rig, session.device.lidars[i].nominal, prior);
  ROOMCAL_TRY(locate_sweeps(session, i, sweeps, lidar.had_prior ? &prior : nullptr, arenas, lidar.location));
  lidar.located = lidar.location.outcome == scan::LocateOutcome::kLocated;
  lidar.T_room_lidar = lidar.location.T_room_lidar;
  if (lidar.located) return ok_status();
  lidar.failure = refusal(lidar.name, lidar.location);
  if (!lidar.had_prior || lidar.location.outcome == scan::LocateOutcome::kAmbiguous) return ok_status();
  const Arena::Scope scope(arenas.step);
  const std::span<scan::Location> alone = arenas.step.allocate<scan::Location>(1);
  if (alone.empty()) return out_of_arena("step arena: no room for a LiDAR's location: reserve plan_memory()");
  ROOMCAL_TRY(locate_sweeps(session, i, sweeps, nullptr, arenas, alone[0]));
  if (alone[0].outcome != scan::LocateOutcome::kLocated) return ok_status();
  lidar.failure = disagreement(lidar.name, prior, alone[0].T_room_lidar);
  lidar.failure_verdict = Verdict::kFailService;
  return ok_status();
}

}  // namespace

Status clean_sweeps(const Sweeps& sweeps, Arena& step, std::span<lidar::Sweep>& clean) {
  clean = step.allocate<lidar::Sweep>(kMaxSweeps);
  if (clean.empty()) return out_of_arena("step arena: no room for sweeps: reserve plan_memory()");
  std::size_t count = 0;
  for (const lidar::Sweep& sweep : sweeps)
    if (usable(sweep) && count < clean.size()) clean[count++] = sweep;
  clean = clean.first(count);
  return ok_status();
}

Status locate_sweeps(const Session& session, std::size_t lidar, const Sweeps& sweeps, const scan::PosePrior* prior,
                     Arenas& arenas, scan::Location& location) {
  const Arena::Scope scope(arenas.step);
  std::span<lidar::Sweep> clean;
  ROOMCAL_TRY(clean_sweeps(sweeps, arenas.step, clean));
  scan::LocateOptions options;
  options.accept.min_azimuth = kFitting * session.limits.min_horizon;
  return scan::locate(*session.surface, clean, session.device.lidars[lidar].ranges, prior, options, arenas.scratch,
                      location);
}

Status locate_lidars(const Session& session, std::span<const Sweeps> sweeps, Steps& steps, Arenas& arenas,
                     Outcome& outcome) {
  const LocatedRig rig = locate_rig(session, outcome);
  for (std::size_t i = 0; i < outcome.lidars.size(); ++i) {
    ROOMCAL_TRY(steps.begin(Stage::kLocateLidars, outcome.lidars[i].name.view()));
    if (outcome.lidars[i].failure.empty())
      ROOMCAL_TRY(locate_one(session, i, sweeps[i], rig, arenas, outcome.lidars[i]));
  }
  return ok_status();
}

}  // namespace roomcal::calib
