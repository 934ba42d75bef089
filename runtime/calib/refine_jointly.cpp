#include "runtime/calib/refine_jointly.h"

#include <algorithm>

#include <Eigen/Cholesky>

#include "runtime/base/reason.h"
#include "runtime/calib/held_out.h"
#include "runtime/calib/locate_sensors.h"
#include "runtime/calib/map_errors.h"

namespace roomcal::calib {

namespace {

// The walls are flat and the loss is three sigmas wide: within this, the quadratic of a sweep's points is exact to a
// hundredth of a sigma (tests/runtime/scan).
constexpr double kLinear_m = 0.005;
constexpr double kLinear_rad = 0.003;

Status collect_rings(Arena& step, CameraOutcome& camera) {
  camera.rings = step.allocate<rig::RingObservation>(camera.inliers.size());
  if (camera.rings.empty()) return out_of_arena("step arena: no room for observations: reserve plan_memory()");
  for (std::size_t k = 0; k < camera.rings.size(); ++k) {
    const marker::Detection& detection = camera.detections[camera.inliers[k].observation];
    camera.rings[k] = {detection.centre_px, detection.cov_px2, camera.inliers[k].marker};
  }
  hold_out_last(camera);
  return ok_status();
}

Status collect_input(const Session& session, std::span<const Sweeps> sweeps, Arenas& arenas, Outcome& outcome) {
  ROOMCAL_TRY(collect_map(session, arenas, outcome));
  for (CameraOutcome& camera : outcome.cameras)
    if (camera.located) ROOMCAL_TRY(collect_rings(arenas.step, camera));
  for (std::size_t i = 0; i < outcome.lidars.size(); ++i)
    if (outcome.lidars[i].located) ROOMCAL_TRY(collect_pulls(session, i, sweeps[i], arenas, outcome));
  return ok_status();
}

void take_cameras(Outcome& outcome) {
  const CameraOutcome& reference = outcome.cameras[outcome.reference];
  for (CameraOutcome& camera : outcome.cameras) {
    if (!camera.located) continue;
    camera.T_room_cam = outcome.solution.T_room_sensor[camera.view];
    camera.rms_px = outcome.solution.rms_px[camera.view];
    if (const rig::RefinedLens* lens = outcome.solution.lens_of(camera.view)) camera.camera = lens->camera;
    if (!reference.located) continue;
    camera.in_rig = true;
    if (&camera == &reference) continue;  // the rig frame is its own: identity, exact
    const rig::RelativePose relative = rig::relative_pose(outcome.solution, reference.view, camera.view);
    camera.T_rig_cam = relative.T_a_b;
    camera.cov_rig_cam = relative.cov;
  }
}

void take_lidars(Outcome& outcome) {
  const CameraOutcome& reference = outcome.cameras[outcome.reference];
  for (LidarOutcome& lidar : outcome.lidars) {
    if (!lidar.located) continue;
    lidar.T_room_lidar = outcome.solution.T_room_sensor[lidar.sensor];
    if (!reference.located) continue;
    lidar.in_rig = true;
    const rig::RelativePose relative = rig::relative_pose(outcome.solution, reference.view, lidar.sensor);
    lidar.T_rig_lidar = relative.T_a_b;
    lidar.cov_rig_lidar = relative.cov;
  }
}

/// Takes cameras out of the located ones: the blamed view, or all sensors where the fit as a whole failed. A single
/// pose without its covariance would be no extrinsic.
void drop(const Status& status, std::size_t blamed_view, Outcome& outcome) {
  for (CameraOutcome& camera : outcome.cameras) {
    if (!camera.located || (status.code() == StatusCode::kDegenerate && camera.view != blamed_view)) continue;
    camera.located = false;
    camera.failure = sensor_reason(camera.name, status);
  }
  if (status.code() == StatusCode::kDegenerate) return;
  for (LidarOutcome& lidar : outcome.lidars) {
    if (!lidar.located) continue;
    lidar.located = false;
    lidar.failure = sensor_reason(lidar.name, status);
  }
}

Status solve(const Session& session, Arenas& arenas, Outcome& outcome) {
  JointProblemInput joint;
  for (;;) {
    number_sensors(session, outcome, joint);
    if (joint.cameras.empty() && joint.lidars.empty()) return ok_status();
    std::size_t blamed_view = 0;
    const Status status = rig::solve_rig(joint.input(outcome), solve_options(session), arenas.step, arenas.scratch,
                                         outcome.solution, &blamed_view);
    if (status.code() == StatusCode::kOutOfMemory) return status;
    if (status.ok()) return ok_status();
    drop(status, blamed_view, outcome);
  }
}

bool left_linear_range(const LidarOutcome& lidar, const rig::RigSolution& solution) {
  const Vec6 moved = se3_log(lidar.location.information.T_hat.inverse() * solution.T_room_sensor[lidar.sensor]);
  return moved.head<3>().norm() > kLinear_m || moved.tail<3>().norm() > kLinear_rad;
}

/// @return whether any LiDAR was located again, and the problem is another one.
Result<bool> relinearize(const Session& session, std::span<const Sweeps> sweeps, Arenas& arenas, Outcome& outcome) {
  bool changed = false;
  for (std::size_t i = 0; i < outcome.lidars.size(); ++i) {
    LidarOutcome& lidar = outcome.lidars[i];
    if (!lidar.located || !left_linear_range(lidar, outcome.solution)) continue;
    changed = true;
    scan::PosePrior prior{outcome.solution.T_room_sensor[lidar.sensor],
                          outcome.solution.cov_block(lidar.sensor, lidar.sensor)};
    prior.cov.diagonal().array() += 1e-12;
    ROOMCAL_TRY(locate_sweeps(session, i, sweeps[i], &prior, arenas, lidar.location));
    lidar.located = lidar.location.outcome == scan::LocateOutcome::kLocated;
    if (lidar.located) ROOMCAL_TRY(collect_pulls(session, i, sweeps[i], arenas, outcome));
    if (lidar.located) continue;
    const Name who(lidar.name);
    lidar.failure =
        make_reason("%.*s: cameras and sweep do not agree on where it is: check its bracket", who.length, who.text);
    lidar.failure_verdict = Verdict::kFailService;
  }
  return changed;
}

}  // namespace

void number_sensors(const Session& session, Outcome& outcome, JointProblemInput& joint) {
  joint.cameras.clear();
  joint.lidars.clear();
  joint.reference = rig::kNoReference;
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
    CameraOutcome& camera = outcome.cameras[i];
    if (!camera.located) continue;
    camera.view = joint.cameras.size();
    if (i == outcome.reference) joint.reference = camera.view;
    static_cast<void>(joint.cameras.push_back(
        {&session.device.cameras[i].camera, camera.rings, camera.T_room_cam, session.device.intrinsics_sigma(i)}));
  }
  for (std::size_t i = 0; i < outcome.lidars.size(); ++i) {
    LidarOutcome& lidar = outcome.lidars[i];
    if (!lidar.located) continue;
    lidar.sensor = joint.cameras.size() + joint.lidars.size();
    const NominalMounting& mounting = session.device.lidars[i].nominal;
    lidar.mount_took_part = mounting.known && joint.reference != rig::kNoReference;
    static_cast<void>(
        joint.lidars.push_back({believed(lidar.location),
                                {mounting.known, mounting.T_rig_sensor, mounting.sigma_t_m, mounting.sigma_rot_rad},
                                scan::kUnseenSigma_m,
                                scan::kUnseenSigma_rad,
                                lidar.pulls}));
  }
}

rig::SolveOptions solve_options(const Session& session) {
  rig::SolveOptions options;
  options.sigma_floor_px = session.sigma_floor_px;
  return options;
}

Status refine_jointly(const Session& session, std::span<const Sweeps> sweeps, Arenas& arenas, Outcome& outcome) {
  const auto located = [](const auto& sensor) { return sensor.located; };
  if (std::none_of(outcome.cameras.begin(), outcome.cameras.end(), located) &&
      std::none_of(outcome.lidars.begin(), outcome.lidars.end(), located))
    return ok_status();
  ROOMCAL_TRY(collect_input(session, sweeps, arenas, outcome));
  ROOMCAL_TRY(solve(session, arenas, outcome));
  const Result<bool> moved = relinearize(session, sweeps, arenas, outcome);
  if (!moved.ok()) return moved.status();
  if (moved.value()) ROOMCAL_TRY(solve(session, arenas, outcome));
  take_cameras(outcome);
  take_lidars(outcome);
  return ok_status();
}

}  // namespace roomcal::calib
