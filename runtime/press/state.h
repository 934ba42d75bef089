#pragma once

#include <cstdint>

#include "runtime/base/verdict.h"

namespace roomcal::press {

/// What the device is doing. Apart from what came of it: a result stays while the device is idle again.
enum class State : uint8_t {
  kIdle,
  kWaitStill,
  kGrab,
  kDetect,
  kLocate,
  kLocateLidars,
  kSolve,
  kJudge,
  kWrite,
  kCheck,  ///< reading back what was written and trying it on the same shot
};
/// "IDLE", "WAIT_STILL", ...
const char* to_string(State state);

/// What was asked for.
enum class Kind : uint8_t {
  kVerify,     ///< measure and compare with the store; never writes
  kCalibrate,  ///< and store it if the verdict lets it
  kDryRun,     ///< as calibrate, without the store
};
/// "verify", "calibrate", "dry-run".
const char* to_string(Kind kind);

enum class Result : uint8_t { kNone, kPass, kPassAdvise, kFailRetry, kFailService, kAborted };
/// "NONE", "PASS", "PASS_ADVISE", "FAIL_RETRY", "FAIL_SERVICE", "ABORTED".
const char* to_string(Result result);
Result to_result(Verdict verdict);

/// Where to look when it did not pass: the number of blinks, printed on the device's label, the same on console and
/// CAN.
enum class Trouble : uint8_t {
  kNone = 0,
  kImages = 1,   ///< light, exposure, a camera that delivers nothing
  kMotion = 2,   ///< the device or the scene does not stand still
  kPlace = 3,    ///< too few markers, or more than one place fits: another position
  kLidar = 4,    ///< a LiDAR: losses, blocked view, not located
  kService = 5,  ///< a sensor has moved in its mount, wrong map, wrong intrinsics
  kStore = 6,    ///< the record could not be written
  kDevice = 7,   ///< the device itself
};
/// "images: light, exposure, lenses, cables". Never null.
const char* to_string(Trouble trouble);

}  // namespace roomcal::press
