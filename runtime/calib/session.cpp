#include "runtime/calib/session.h"

#include <algorithm>
#include <array>

#include "runtime/calib/preflight.h"
#include "runtime/calib/reason.h"

namespace roomcal::calib {

namespace {

/// Runs one step of the session and notes its time.
template <typename Step>
Status timed(Stage stage, const ports::Clock& clock, Outcome& outcome, const Step& step) {
  const int64_t start_ns = clock.now_ns();
  const Status status = step();
  outcome.stage_ns[static_cast<std::size_t>(stage)] = clock.now_ns() - start_ns;
  return status;
}

/// "<camera>: <code>: <detail>", for a status that a camera ran into.
Reason camera_reason(const SensorName& name, const Status& status) {
  return make_reason("%.*s: %s: %s", static_cast<int>(name.view().size()), name.view().data(), to_string(status.code()),
                     status.detail());
}

void preflight(const Session& session, std::span<const ImageView> images, Outcome& outcome) {
  outcome.reference = session.device.reference;
  for (std::size_t i = 0; i < images.size(); ++i) {
    CameraOutcome camera;
    camera.name = session.device.cameras[i].name;
    camera.has_image = !images[i].empty();
    camera.failure = check_image(session.device.cameras[i], images[i]);
    static_cast<void>(outcome.cameras.push_back(camera));  // as many as the device's, same capacity
  }
}

Status detect(std::span<const ImageView> images, Arenas& arenas, Outcome& outcome) {
  for (std::size_t i = 0; i < images.size(); ++i) {
    CameraOutcome& camera = outcome.cameras[i];
    if (!camera.failure.empty()) continue;
    const auto detections = arenas.step.allocate<marker::Detection>(kMaxDetections);
    if (detections.empty()) return out_of_arena("step arena: no room for detections: reserve plan_memory()");
    std::size_t count = 0;
    const Status status = marker::detect(images[i], {}, arenas.scratch, detections, count);
    if (status.code() == StatusCode::kOutOfMemory) return status;
    if (!status.ok() && status.code() != StatusCode::kCapacity) camera.failure = camera_reason(camera.name, status);
    camera.detections = detections.first(count);
    camera.usable_detections = static_cast<std::size_t>(
        std::count_if(camera.detections.begin(), camera.detections.end(),
                      [](const marker::Detection& d) { return d.status == marker::DetectionStatus::kOk; }));
  }
  return ok_status();
}

pose::Observation to_observation(const marker::Detection& detection) {
  return {detection.centre_px, detection.cov_px2, detection.ellipse.major_px, detection.ellipse.minor_px,
          detection.ellipse.angle_rad};
}

Status locate_one(const Session& session, std::size_t i, Arenas& arenas, CameraOutcome& camera) {
  const auto observations = arenas.step.allocate<pose::Observation>(camera.usable_detections);
  for (std::size_t k = 0; k < observations.size(); ++k) observations[k] = to_observation(camera.detections[k]);
  pose::CameraLocation location;
  const Status status = pose::locate_camera(session.device.cameras[i].camera, observations, session.index, {},
                                            arenas.step, arenas.scratch, location);
  if (status.code() == StatusCode::kOutOfMemory) return status;
  if (!status.ok()) {
    camera.failure = camera_reason(camera.name, status);
    return ok_status();
  }
  camera.located = true;
  camera.T_room_cam = location.T_room_cam;
  camera.inliers = location.inliers;
  camera.coverage = location.coverage;
  camera.log_likelihood_gap = location.log_likelihood_gap;
  return ok_status();
}

Status locate_cameras(const Session& session, Arenas& arenas, Outcome& outcome) {
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i)
    if (outcome.cameras[i].failure.empty()) ROOMCAL_TRY(locate_one(session, i, arenas, outcome.cameras[i]));
  return ok_status();
}

/// What the joint problem is made of. Spans live in the step arena.
struct JointInput {
  std::span<rig::Landmark> landmarks;                              ///< the map's markers, all of them, in its numbering
  std::array<std::span<rig::RingObservation>, kMaxCameras> rings;  ///< of every located camera
};

Status collect_rings(const CameraOutcome& camera, Arena& step, std::span<rig::RingObservation>& rings) {
  rings = step.allocate<rig::RingObservation>(camera.inliers.size());
  if (rings.empty()) return out_of_arena("step arena: no room for observations: reserve plan_memory()");
  for (std::size_t k = 0; k < rings.size(); ++k) {
    const marker::Detection& detection = camera.detections[camera.inliers[k].observation];
    rings[k] = {detection.centre_px, detection.cov_px2, camera.inliers[k].marker};
  }
  return ok_status();
}

Status collect_input(const Session& session, const Outcome& outcome, Arena& step, JointInput& input) {
  input.landmarks = step.allocate<rig::Landmark>(session.map.marker_count());
  if (input.landmarks.empty()) return out_of_arena("step arena: no room for landmarks: reserve plan_memory()");
  for (std::size_t m = 0; m < input.landmarks.size(); ++m) {
    const map::MapMarker marker = session.map.marker(m);
    input.landmarks[m] = {marker.p_room, marker.cov_m2};
  }
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i)
    if (outcome.cameras[i].located) ROOMCAL_TRY(collect_rings(outcome.cameras[i], step, input.rings[i]));
  return ok_status();
}

void take_solution(Outcome& outcome) {
  const CameraOutcome& reference = outcome.cameras[outcome.reference];
  for (CameraOutcome& camera : outcome.cameras) {
    if (!camera.located) continue;
    camera.T_room_cam = outcome.solution.T_room_cam[camera.view];
    camera.rms_px = outcome.solution.rms_px[camera.view];
    if (!reference.located) continue;
    camera.in_rig = true;
    if (&camera == &reference) continue;  // the rig frame is its own: identity, exact
    const rig::RelativePose relative = rig::relative_pose(outcome.solution, reference.view, camera.view);
    camera.T_rig_cam = relative.T_a_b;
    camera.cov_rig_cam = relative.cov;
  }
}

using Views = FixedVector<rig::CameraView, kMaxCameras>;

void number_views(const Session& session, const JointInput& input, Outcome& outcome, Views& views) {
  views.clear();
  for (std::size_t i = 0; i < outcome.cameras.size(); ++i) {
    CameraOutcome& camera = outcome.cameras[i];
    if (!camera.located) continue;
    camera.view = views.size();
    static_cast<void>(views.push_back({&session.device.cameras[i].camera, input.rings[i], camera.T_room_cam}));
  }
}

/// Takes cameras out of the located ones: the blamed view, or all of them where the fit as a whole failed. A single
/// pose without its covariance would be no extrinsic.
void drop(const Status& status, std::size_t blamed_view, Outcome& outcome) {
  for (CameraOutcome& camera : outcome.cameras) {
    if (!camera.located || (status.code() == StatusCode::kDegenerate && camera.view != blamed_view)) continue;
    camera.located = false;
    camera.failure = camera_reason(camera.name, status);
  }
}

/// Solves for all located cameras; one that its markers do not determine is left out and the rest solved again.
Status refine_jointly(const Session& session, Arenas& arenas, Outcome& outcome) {
  const auto is_located = [](const CameraOutcome& camera) { return camera.located; };
  if (std::none_of(outcome.cameras.begin(), outcome.cameras.end(), is_located)) return ok_status();
  JointInput input;
  ROOMCAL_TRY(collect_input(session, outcome, arenas.step, input));
  rig::SolveOptions options;
  options.sigma_floor_px = session.sigma_floor_px;
  Views views;
  for (number_views(session, input, outcome, views); !views.empty(); number_views(session, input, outcome, views)) {
    std::size_t blamed_view = 0;
    const Status status = rig::solve_cameras(views.span(), input.landmarks, options, arenas.step, arenas.scratch,
                                             outcome.solution, &blamed_view);
    if (status.code() == StatusCode::kOutOfMemory) return status;
    if (status.ok()) {
      take_solution(outcome);
      return ok_status();
    }
    drop(status, blamed_view, outcome);
  }
  return ok_status();
}

}  // namespace

Status calibrate(const Session& session, std::span<const ImageView> images, const ports::Clock& clock, Arenas& arenas,
                 Outcome& outcome) {
  outcome = Outcome();  // FAIL_SERVICE until it is judged
  if (images.size() != session.device.cameras.size() || images.empty())
    return {StatusCode::kInvalidArgument, "one image per camera of the device is needed, empty where one is missing"};
  preflight(session, images, outcome);
  ROOMCAL_TRY(timed(Stage::kDetect, clock, outcome, [&] { return detect(images, arenas, outcome); }));
  ROOMCAL_TRY(timed(Stage::kLocate, clock, outcome, [&] { return locate_cameras(session, arenas, outcome); }));
  ROOMCAL_TRY(timed(Stage::kRefine, clock, outcome, [&] { return refine_jointly(session, arenas, outcome); }));
  return timed(Stage::kJudge, clock, outcome, [&] {
    judge(session.device, session.limits, outcome);
    return ok_status();
  });
}

}  // namespace roomcal::calib
