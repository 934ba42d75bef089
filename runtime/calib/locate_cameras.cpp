#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "runtime/base/reason.h"
#include "runtime/calib/locate_sensors.h"
#include "runtime/calib/misfit.h"
#include "runtime/calib/preflight.h"
#include "runtime/rig/reprojection.h"

namespace roomcal::calib {

namespace {

CameraOutcome& add_camera(const CameraSpec& spec, Outcome& outcome) {
  CameraOutcome camera;
  camera.name = spec.name;
  camera.camera = spec.camera;
  static_cast<void>(outcome.cameras.push_back(camera));  // as many as the device's, same capacity
  return outcome.cameras.back();
}

void preflight_lidars(const Session& session, std::span<const Sweeps> sweeps, Outcome& outcome) {
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    static_cast<void>(outcome.lidars.push_back({}));  // as many as the device's, same capacity
    check_sweeps(session.device.lidars[i], sweeps[i], session.limits, outcome.lidars.back());
  }
}

/// Rings as the camera's calibration lets them count: what it says of a pixel's direction is itself good to sigma_px.
void take(const CameraSpec& spec, std::span<marker::Detection> detections, CameraOutcome& camera) {
  for (marker::Detection& ring : detections) ring.cov_px2.diagonal().array() += spec.sigma_px * spec.sigma_px;
  camera.detections = detections;
  camera.usable_detections =
      static_cast<std::size_t>(std::count_if(detections.begin(), detections.end(), [](const marker::Detection& d) {
        return d.status == marker::DetectionStatus::kOk;
      }));
}

pose::Observation to_observation(const marker::Detection& detection) {
  return {detection.centre_px, detection.cov_px2, detection.ellipse.major_px, detection.ellipse.minor_px,
          detection.ellipse.angle_rad};
}

/// What intrinsics that may be off leave of a located pose, beside what each ring's own covariance says: they move all
/// rings of the image together. With H = sum J' W J and F = sum J' W J_k sigma_k it is H^-1 F F' H^-1.
Mat66 cov_by_intrinsics(const camera::Camera& camera, const camera::Parameters& sigma,
                        std::span<const pose::Observation> observations, const map::TriangleIndex& index,
                        const pose::CameraLocation& location) {
  Mat66 H = Mat66::Zero();
  Eigen::Matrix<double, 6, camera::kIntrinsicsCount> F = decltype(F)::Zero();
  for (const pose::Correspondence& inlier : location.inliers) {
    const pose::Observation& seen = observations[inlier.observation];
    rig::Reprojection at;
    const Vec3& p_room = index.markers()[inlier.marker].p_room;
    if (!rig::reproject(camera, location.T_room_cam, p_room, seen.centre_px, at).ok()) continue;
    const Eigen::Matrix<double, 6, 2> JtW = at.J_pose.transpose() * seen.cov_px2.inverse();
    H += JtW * at.J_pose;
    F += JtW * at.J_intrinsics * sigma.asDiagonal();
  }
  const Eigen::Matrix<double, 6, camera::kIntrinsicsCount> G = H.ldlt().solve(F);
  return G * G.transpose();
}

/// A better reason than "not found", where there is one: then it is no longer the operator's to mend.
void explain(const CameraSpec& spec, std::span<pose::Observation> observations, const map::TriangleIndex& index,
             Arenas& arenas, CameraOutcome& camera) {
  const Reason misfit = explain_misfit(spec, observations, index, arenas.step, arenas.scratch);
  if (misfit.empty()) return;
  camera.failure = misfit;
  camera.failure_verdict = Verdict::kFailService;
}

Status locate_one(const Session& session, std::size_t i, Arenas& arenas, CameraOutcome& camera) {
  const auto observations = arenas.step.allocate<pose::Observation>(camera.usable_detections);
  const camera::Camera& lens = session.device.cameras[i].camera;
  const camera::Parameters sigma = session.device.intrinsics_sigma(i);
  const bool refine = !sigma.isZero(0);
  for (std::size_t k = 0; k < observations.size(); ++k) {
    observations[k] = to_observation(camera.detections[k]);
    if (refine) observations[k].cov_px2 += camera::pixel_covariance(lens, sigma, observations[k].centre_px);
  }
  pose::LocateOptions options;
  options.min_inliers = static_cast<int>(session.limits.min_inliers);
  options.min_log_likelihood_gap = session.limits.min_log_likelihood_gap;
  pose::CameraLocation location;
  const Status status =
      pose::locate_camera(lens, observations, session.index, options, arenas.step, arenas.scratch, location);
  if (status.code() == StatusCode::kOutOfMemory) return status;
  if (!status.ok()) {
    camera.failure = sensor_reason(camera.name, status);
    if (status.code() == StatusCode::kNotFound)
      explain(session.device.cameras[i], observations, session.index, arenas, camera);
    return ok_status();
  }
  camera.located = true;
  camera.T_room_cam = location.T_room_cam;
  camera.cov_room_cam = location.cov;
  if (refine) camera.cov_room_cam += cov_by_intrinsics(lens, sigma, observations, session.index, location);
  camera.inliers = location.inliers;
  camera.coverage = location.coverage;
  camera.log_likelihood_gap = location.log_likelihood_gap;
  return ok_status();
}

}  // namespace

void preflight(const Session& session, const Shot& shot, Outcome& outcome) {
  outcome.reference = session.device.reference;
  for (std::size_t i = 0; i < shot.images.size(); ++i) {
    CameraOutcome& camera = add_camera(session.device.cameras[i], outcome);
    camera.has_image = !shot.images[i].empty();
    camera.failure = check_image(session.device.cameras[i], shot.images[i]);
  }
  preflight_lidars(session, shot.sweeps, outcome);
}

void take_detections(const Session& session, const DetectedShot& shot, Outcome& outcome) {
  outcome.reference = session.device.reference;
  for (std::size_t i = 0; i < shot.rings.size(); ++i) {
    CameraOutcome& camera = add_camera(session.device.cameras[i], outcome);
    camera.has_image = !shot.rings[i].empty();
    if (!camera.has_image) camera.failure = check_image(session.device.cameras[i], {});
    take(session.device.cameras[i], shot.rings[i], camera);
  }
  preflight_lidars(session, shot.sweeps, outcome);
}

Status detect(const Session& session, std::span<const ImageView> images, Steps& steps, Arenas& arenas,
              Outcome& outcome) {
  for (std::size_t i = 0; i < images.size(); ++i) {
    CameraOutcome& camera = outcome.cameras[i];
    ROOMCAL_TRY(steps.begin(Stage::kDetect, camera.name.view()));
    if (!camera.failure.empty()) continue;
    const auto detections = arenas.step.allocate<marker::Detection>(kMaxDetections);
    if (detections.empty()) return out_of_arena("step arena: no room for detections: reserve plan_memory()");
    std::size_t count = 0;
    const Status status = marker::detect(images[i], {}, arenas.scratch, detections, count);
    if (status.code() == StatusCode::kOutOfMemory) return status;
    if (!status.ok() && status.code() != StatusCode::kCapacity) camera.failure = sensor_reason(camera.name, status);
    take(session.device.cameras[i], detections.first(count), camera);
    camera.detections_complete = status.code() != StatusCode::kCapacity;
  }
  return ok_status();
}

Status locate_cameras(const Session& session, Steps& steps, Arenas& arenas, Outcome& outcome) {
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
    ROOMCAL_TRY(steps.begin(Stage::kLocate, outcome.cameras[i].name.view()));
    if (outcome.cameras[i].failure.empty()) ROOMCAL_TRY(locate_one(session, i, arenas, outcome.cameras[i]));
  }
  return ok_status();
}

}  // namespace roomcal::calib
