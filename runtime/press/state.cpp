#include "runtime/press/state.h"

namespace roomcal::press {

const char* to_string(State state) {
  switch (state) {
    case State::kIdle:
      return "IDLE";
    case State::kWaitStill:
      return "WAIT_STILL";
    case State::kGrab:
      return "GRAB";
    case State::kDetect:
      return "DETECT";
    case State::kLocate:
      return "LOCATE";
    case State::kLocateLidars:
      return "LOCATE_LIDARS";
    case State::kSolve:
      return "SOLVE";
    case State::kJudge:
      return "JUDGE";
    case State::kWrite:
      return "WRITE";
    case State::kCheck:
      return "CHECK";
  }
  return "UNKNOWN";
}

const char* to_string(Kind kind) {
  switch (kind) {
    case Kind::kVerify:
      return "verify";
    case Kind::kCalibrate:
      return "calibrate";
    case Kind::kDryRun:
      return "dry-run";
  }
  return "unknown";
}

const char* to_string(Result result) {
  switch (result) {
    case Result::kNone:
      return "NONE";
    case Result::kPass:
      return "PASS";
    case Result::kPassAdvise:
      return "PASS_ADVISE";
    case Result::kFailRetry:
      return "FAIL_RETRY";
    case Result::kFailService:
      return "FAIL_SERVICE";
    case Result::kAborted:
      return "ABORTED";
  }
  return "UNKNOWN";
}

Result to_result(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return Result::kPass;
    case Verdict::kPassAdvise:
      return Result::kPassAdvise;
    case Verdict::kFailRetry:
      return Result::kFailRetry;
    case Verdict::kFailService:
      return Result::kFailService;
  }
  return Result::kFailService;
}

const char* to_string(Trouble trouble) {
  switch (trouble) {
    case Trouble::kNone:
      return "none";
    case Trouble::kImages:
      return "images: light, exposure, lenses, cables";
    case Trouble::kMotion:
      return "motion: keep the device and its surroundings still";
    case Trouble::kPlace:
      return "place: stand where more markers are seen";
    case Trouble::kLidar:
      return "LiDAR: view, cable, network";
    case Trouble::kService:
      return "service: a sensor has moved, or map or intrinsics are wrong";
    case Trouble::kStore:
      return "store: the record could not be written";
    case Trouble::kDevice:
      return "device: see its log";
  }
  return "unknown";
}

}  // namespace roomcal::press
