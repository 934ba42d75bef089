#include "runtime/face/light_grammar.h"

namespace roomcal::face {

namespace {

constexpr int64_t kMs = 1'000'000;
constexpr int64_t kFlash_ns = 150 * kMs, kGap_ns = 250 * kMs, kPause_ns = 1'200 * kMs, kLong_ns = 800 * kMs;
constexpr int64_t kAlivePeriod_ns = 3'000 * kMs, kPassOn_ns = 3'000 * kMs;
constexpr uint8_t kSafeModeFlashes = 5;

/// n flashes from the beginning; `at_ns` is beyond them in the pause.
bool in_flashes(uint8_t count, int64_t at_ns) {
  const int64_t period_ns = kFlash_ns + kGap_ns;
  return at_ns >= 0 && at_ns < count * period_ns && at_ns % period_ns < kFlash_ns;
}

int64_t flashes_ns(uint8_t count) { return count * (kFlash_ns + kGap_ns); }

LightPattern of_state(press::State state) {
  switch (state) {
    case press::State::kWaitStill:
      return {Light::kSlowPulse, 0};
    case press::State::kGrab:
      return {Light::kBlinks, 1};
    case press::State::kDetect:
      return {Light::kBlinks, 2};
    case press::State::kLocate:
      return {Light::kBlinks, 3};
    case press::State::kLocateLidars:
      return {Light::kBlinks, 4};
    case press::State::kSolve:
    case press::State::kJudge:
      return {Light::kBlinks, 5};
    case press::State::kWrite:
    case press::State::kCheck:
      return {Light::kFast, 0};
    case press::State::kIdle:
      break;
  }
  return {};
}

LightPattern of_result(press::Result result, press::Trouble trouble) {
  const auto number = static_cast<uint8_t>(trouble);
  switch (result) {
    case press::Result::kPass:
      return {Light::kOnce, 0};
    case press::Result::kPassAdvise:
      return {Light::kTwoLong, 0};
    case press::Result::kFailRetry:
      return {Light::kBlinks, number};
    case press::Result::kFailService:
      return {Light::kLongThenBlinks, number};
    case press::Result::kAborted:
    case press::Result::kNone:
      break;
  }
  return {};
}

LightPattern of_rest(const LightInput& input) {
  if (input.store == store::State::kUncalibrated) return {Light::kAlive, 3};
  if (input.store == store::State::kFactory || input.sensor_faulted) return {Light::kAlive, 2};
  return {Light::kAlive, 1};
}

}  // namespace

LightPattern choose_light(const LightInput& input) {
  if (input.safe_mode) return {Light::kBlinks, kSafeModeFlashes};
  if (input.state != press::State::kIdle) return of_state(input.state);
  if (input.hold == Hold::kOffer || input.offered) return {Light::kFast, 0};
  if (input.hold == Hold::kCalibrate) return {Light::kOn, 0};
  if (input.hold != Hold::kUp) return {Light::kOff, 0};
  if (const LightPattern result = of_result(input.result, input.trouble); result.light != Light::kOff) return result;
  return of_rest(input);
}

bool is_lit(const LightPattern& pattern, int64_t since_ns) {
  switch (pattern.light) {
    case Light::kOff:
      return false;
    case Light::kOn:
      return true;
    case Light::kFast:
      return since_ns % (125 * kMs) < 62 * kMs;
    case Light::kSlowPulse:
      return since_ns % (1'000 * kMs) < 500 * kMs;
    case Light::kAlive:
      return in_flashes(pattern.blinks, since_ns % kAlivePeriod_ns);
    case Light::kBlinks:
      return in_flashes(pattern.blinks, since_ns % (flashes_ns(pattern.blinks) + kPause_ns));
    case Light::kTwoLong:
      return since_ns % (kLong_ns + kGap_ns) < kLong_ns && since_ns < duration_ns(pattern);
    case Light::kOnce:
      return since_ns < kPassOn_ns;
    case Light::kLongThenBlinks: {
      const int64_t head_ns = kLong_ns + 2 * kGap_ns;
      const int64_t at_ns = since_ns % (head_ns + flashes_ns(pattern.blinks) + kPause_ns);
      return at_ns < kLong_ns || in_flashes(pattern.blinks, at_ns - head_ns);
    }
  }
  return false;
}

int64_t duration_ns(const LightPattern& pattern) {
  if (pattern.light == Light::kOnce) return kPassOn_ns;
  if (pattern.light == Light::kTwoLong) return 2 * (kLong_ns + kGap_ns);
  return 0;
}

bool LightPlayer::lit(const LightInput& input, int64_t now_ns) {
  LightPattern wanted = choose_light(input);
  const int64_t once_ns = duration_ns(wanted);
  if (wanted == pattern_ && once_ns > 0 && now_ns - since_ns_ >= once_ns) return is_lit(of_rest(input), now_ns);
  if (!(wanted == pattern_)) {
    pattern_ = wanted;
    since_ns_ = now_ns;
  }
  return is_lit(pattern_, now_ns - since_ns_);
}

}  // namespace roomcal::face
