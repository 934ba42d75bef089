#include "runtime/calib/session.h"

#include "runtime/calib/compare_installed.h"
#include "runtime/calib/held_out.h"
#include "runtime/calib/judgement.h"
#include "runtime/calib/locate_sensors.h"
#include "runtime/calib/refine_jointly.h"

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

Status check_shot(const Session& session, std::size_t cameras, std::size_t lidars) {
  if (cameras != session.device.cameras.size() || cameras == 0)
    return {StatusCode::kInvalidArgument, "one image per camera of the device is needed, empty where one is missing"};
  if (lidars != session.device.lidars.size())
    return {StatusCode::kInvalidArgument,
            "one set of sweeps per LiDAR of the device is needed, empty where one is missing"};
  if (lidars > 0 && session.surface == nullptr)
    return {StatusCode::kInvalidArgument, "a session with LiDARs needs the map's surface"};
  return ok_status();
}

/// Everything after the rings are detected.
Status conclude(const Session& session, std::span<const Sweeps> sweeps, const ports::Clock& clock, Steps& steps,
                Arenas& arenas, Outcome& outcome) {
  ROOMCAL_TRY(timed(Stage::kLocate, clock, outcome, [&] { return locate_cameras(session, steps, arenas, outcome); }));
  ROOMCAL_TRY(timed(Stage::kLocateLidars, clock, outcome,
                    [&] { return locate_lidars(session, sweeps, steps, arenas, outcome); }));
  ROOMCAL_TRY(steps.begin(Stage::kRefine));
  ROOMCAL_TRY(timed(Stage::kRefine, clock, outcome, [&] { return refine_jointly(session, sweeps, arenas, outcome); }));
  ROOMCAL_TRY(steps.begin(Stage::kJudge));
  return timed(Stage::kJudge, clock, outcome, [&] {
    ROOMCAL_TRY(predict_held_out(session, arenas, outcome));
    compare_installed(session, outcome);
    judge(session.device, session.limits, outcome);
    return ok_status();
  });
}

/// Steps of a session after its rings are detected: every sensor located, one joint solution, one judgement.
std::size_t steps_to_conclude(const Device& device) { return device.cameras.size() + device.lidars.size() + 2; }

/// What a stopped session leaves: a reason, and nothing that could be taken for an extrinsic.
void discard(const Progress& stopped, Outcome& outcome) {
  for (CameraOutcome& camera : outcome.cameras) camera.in_rig = false;
  for (LidarOutcome& lidar : outcome.lidars) lidar.in_rig = false;
  const std::string_view who = stopped.sensor.empty() ? "session" : stopped.sensor;
  Judgement(outcome).add(Verdict::kFailRetry,
                         make_reason("%.*s: stopped before %s: nothing is stored, start again",
                                     static_cast<int>(who.size()), who.data(), to_string(stopped.stage)));
}

Status discard_if_stopped(const Status& status, const Steps& steps, Outcome& outcome) {
  if (status.code() == StatusCode::kCancelled) discard(steps.progress(), outcome);
  return status;
}

}  // namespace

Status calibrate(const Session& session, const Shot& shot, const ports::Clock& clock, Arenas& arenas, Outcome& outcome,
                 Observer* observer) {
  outcome = Outcome();  // FAIL_SERVICE until it is judged
  ROOMCAL_TRY(check_shot(session, shot.images.size(), shot.sweeps.size()));
  Steps steps(observer, session.device.cameras.size() + steps_to_conclude(session.device));
  preflight(session, shot, outcome);
  Status status =
      timed(Stage::kDetect, clock, outcome, [&] { return detect(session, shot.images, steps, arenas, outcome); });
  if (status.ok()) status = conclude(session, shot.sweeps, clock, steps, arenas, outcome);
  return discard_if_stopped(status, steps, outcome);
}

Status calibrate(const Session& session, const DetectedShot& shot, const ports::Clock& clock, Arenas& arenas,
                 Outcome& outcome, Observer* observer) {
  outcome = Outcome();
  ROOMCAL_TRY(check_shot(session, shot.rings.size(), shot.sweeps.size()));
  Steps steps(observer, steps_to_conclude(session.device));
  take_detections(session, shot, outcome);
  return discard_if_stopped(conclude(session, shot.sweeps, clock, steps, arenas, outcome), steps, outcome);
}

}  // namespace roomcal::calib
