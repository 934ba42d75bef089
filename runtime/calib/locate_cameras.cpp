#include <algorithm>

#include "runtime/base/reason.h"
#include "runtime/calib/locate_sensors.h"
#include "runtime/calib/misfit.h"
#include "runtime/calib/preflight.h"

namespace roomcal::calib {

namespace {

CameraOutcome& add_camera(const CameraSpec& spec, Outcome& outcome) {
  CameraOutcome camera;
  camera.name = spec.name;
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
  for (std::size_t k = 0; k < observations.size(); ++k) observations[k] = to_observation(camera.detections[k]);
  pose::LocateOptions options;
  options.min_inliers = static_cast<int>(session.limits.min_inliers);
  options.min_log_likelihood_gap = session.limits.min_log_likelihood_gap;
  pose::CameraLocation location;
  const Status status = pose::locate_camera(session.device.cameras[i].camera, observations, session.index, options,
                                            arenas.step, arenas.scratch, location);
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
