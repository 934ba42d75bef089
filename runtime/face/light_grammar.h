#pragma once

#include <cstdint>

#include "runtime/face/button_grammar.h"
#include "runtime/press/state.h"
#include "runtime/store/store.h"

namespace roomcal::face {

/// What the lamp is to tell, most urgent first.
struct LightInput {
  bool safe_mode = false;  ///< nothing works but the console
  Hold hold = Hold::kUp;
  bool offered = false;
  press::State state = press::State::kIdle;
  press::Result result = press::Result::kNone;  ///< of the last press, until it was acknowledged
  press::Trouble trouble = press::Trouble::kNone;
  store::State store = store::State::kUncalibrated;
  bool sensor_faulted = false;
};

/// One pattern: `blinks` short flashes, then a pause; or steady light, or a beat.
enum class Light : uint8_t {
  kOff,
  kOn,
  kFast,            ///< 8 Hz: writing, or a restore is offered
  kSlowPulse,       ///< 1 Hz, half on: waiting for stillness
  kAlive,           ///< a flash every 3 s
  kBlinks,          ///< n flashes and a pause
  kTwoLong,         ///< two long ones, once
  kOnce,            ///< on for 3 s, once
  kLongThenBlinks,  ///< a long one, n flashes, a pause: service
};
struct LightPattern {
  Light light = Light::kOff;
  uint8_t blinks = 0;
  friend bool operator==(const LightPattern&, const LightPattern&) = default;
};

/// The grammar, printed on the device's label (board/README.md):
///
/// | the device                     | lamp |
/// |---|---|
/// | safe mode                      | 5 flashes, pause |
/// | button held for 3 s            | steady: release to calibrate |
/// | button held for 10 s, offered  | fast: press shortly to restore the factory record |
/// | waits for stillness            | slow pulse |
/// | grabs, detects, locates, LiDARs, solves | 1, 2, 3, 4, 5 flashes, pause |
/// | writes and checks              | fast: do not switch off |
/// | PASS                           | on for 3 s |
/// | PASS_ADVISE                    | two long ones |
/// | FAIL_RETRY                     | 1 to 7 flashes, pause: the trouble's number |
/// | FAIL_SERVICE                   | a long one, then the trouble's number |
/// | calibrated, all sensors work   | a flash every 3 s |
/// | factory record, or a sensor is down | 2 flashes every 3 s |
/// | UNCALIBRATED                   | 3 flashes every 3 s |
LightPattern choose_light(const LightInput& input);

/// Whether the lamp is lit at a time within its pattern.
bool is_lit(const LightPattern& pattern, int64_t since_ns);
/// How long a pattern that is shown once takes; 0: it goes on for ever.
int64_t duration_ns(const LightPattern& pattern);

/// Follows the input: restarts a pattern when it changes, ends what is shown once.
class LightPlayer {
 public:
  bool lit(const LightInput& input, int64_t now_ns);
  const LightPattern& pattern() const { return pattern_; }

 private:
  LightPattern pattern_;
  int64_t since_ns_ = 0;
};

}  // namespace roomcal::face
