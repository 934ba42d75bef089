// What the device's label prints (board/README.md), held against the lamp.
#include "runtime/face/light_grammar.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::face {
namespace {

using press::Result;
using press::State;
using press::Trouble;

constexpr int64_t kMs = 1'000'000;
constexpr int64_t kTick_ms = 5;

LightInput calibrated() {
  LightInput input;
  input.store = store::State::kCalibrated;
  return input;
}
LightInput in_state(State state) {
  LightInput input = calibrated();
  input.state = state;
  return input;
}
LightInput after(Result result, Trouble trouble = Trouble::kNone) {
  LightInput input = calibrated();
  input.result = result;
  input.trouble = trouble;
  return input;
}

/// What somebody sees who looks on for a while.
struct Seen {
  int flashes = 0;          ///< times that it went on
  int64_t lit_ms = 0;       ///< in all
  int64_t longest_ms = 0;   ///< at once
  int64_t last_lit_ms = 0;  ///< when it was last on
};
Seen watch(LightPlayer& player, const LightInput& input, int64_t from_ms, int64_t for_ms) {
  Seen seen;
  int64_t since_ms = -1;
  for (int64_t at_ms = from_ms; at_ms < from_ms + for_ms; at_ms += kTick_ms) {
    if (!player.lit(input, at_ms * kMs)) {
      since_ms = -1;
      continue;
    }
    if (since_ms < 0) {
      since_ms = at_ms;
      ++seen.flashes;
    }
    seen.lit_ms += kTick_ms;
    seen.last_lit_ms = at_ms - from_ms;
    seen.longest_ms = std::max(seen.longest_ms, at_ms - since_ms + kTick_ms);
  }
  return seen;
}
Seen watch(const LightInput& input, int64_t for_ms) {
  LightPlayer player;
  return watch(player, input, 1'000, for_ms);
}

/// Flashes between two pauses of half a second or more.
int flashes_in_a_row(const LightInput& input) {
  LightPlayer player;
  int count = 0;
  std::vector<int> rows;
  int64_t dark_ms = 0;
  bool was_lit = false;
  for (int64_t at_ms = 0; at_ms < 20'000; at_ms += kTick_ms) {
    const bool lit = player.lit(input, at_ms * kMs);
    if (lit && !was_lit) {
      if (dark_ms >= 500 && count > 0) {
        rows.push_back(count);
        count = 0;
      }
      ++count;
    }
    dark_ms = lit ? 0 : dark_ms + kTick_ms;
    was_lit = lit;
  }
  EXPECT_GE(rows.size(), 2U);
  for (const int row : rows) EXPECT_EQ(row, rows[0]);
  return rows.empty() ? 0 : rows[0];
}

TEST(ChooseLight, TheMoreUrgentComesFirst) {
  LightInput input = after(Result::kFailService, Trouble::kStore);
  const LightPattern service = choose_light(input);
  EXPECT_EQ(service, (LightPattern{Light::kLongThenBlinks, 6}));
  input.hold = Hold::kShort;
  EXPECT_EQ(choose_light(input), (LightPattern{Light::kOff, 0})) << "whoever presses sees that it is taken";
  input.hold = Hold::kCalibrate;
  EXPECT_EQ(choose_light(input), (LightPattern{Light::kOn, 0}));
  input.hold = Hold::kOffer;
  EXPECT_EQ(choose_light(input), (LightPattern{Light::kFast, 0}));
  input.state = State::kGrab;
  EXPECT_EQ(choose_light(input), (LightPattern{Light::kBlinks, 1}));
  input.safe_mode = true;
  EXPECT_EQ(choose_light(input), (LightPattern{Light::kBlinks, 5}));
}

TEST(ChooseLight, Offered_IsFastUntilItLapses) {
  LightInput input = calibrated();
  input.offered = true;
  EXPECT_EQ(choose_light(input), (LightPattern{Light::kFast, 0}));
}

TEST(ChooseLight, AbortedPress_LeavesNoMark) {
  EXPECT_EQ(choose_light(after(Result::kAborted)), choose_light(calibrated()));
}

TEST(Lamp, Rest_CountsFlashesEveryThreeSeconds) {
  EXPECT_EQ(watch(calibrated(), 9'000).flashes, 3);
  LightInput input = calibrated();
  input.sensor_faulted = true;
  EXPECT_EQ(watch(input, 9'000).flashes, 6);
  input = calibrated();
  input.store = store::State::kFactory;
  EXPECT_EQ(watch(input, 9'000).flashes, 6);
  input.store = store::State::kUncalibrated;
  input.sensor_faulted = true;
  EXPECT_EQ(watch(input, 9'000).flashes, 9) << "without extrinsics nothing else matters";
}

TEST(Lamp, StagesOfAPress_CountUp) {
  EXPECT_EQ(flashes_in_a_row(in_state(State::kGrab)), 1);
  EXPECT_EQ(flashes_in_a_row(in_state(State::kDetect)), 2);
  EXPECT_EQ(flashes_in_a_row(in_state(State::kLocate)), 3);
  EXPECT_EQ(flashes_in_a_row(in_state(State::kLocateLidars)), 4);
  EXPECT_EQ(flashes_in_a_row(in_state(State::kSolve)), 5);
  EXPECT_EQ(flashes_in_a_row(in_state(State::kJudge)), 5);
}

TEST(Lamp, WaitingForStillness_PulsesSlowlyAndWritingFast) {
  const Seen waiting = watch(in_state(State::kWaitStill), 10'000);
  EXPECT_EQ(waiting.flashes, 10);
  EXPECT_NEAR(static_cast<double>(waiting.lit_ms), 5'000, 100);
  for (const State state : {State::kWrite, State::kCheck}) EXPECT_EQ(watch(in_state(state), 10'000).flashes, 80);
}

TEST(Lamp, Pass_IsOnForThreeSecondsAndThenRests) {
  LightPlayer player;
  const Seen first = watch(player, after(Result::kPass), 0, 3'000);
  EXPECT_EQ(first.flashes, 1);
  EXPECT_EQ(first.longest_ms, 3'000);
  EXPECT_EQ(watch(player, after(Result::kPass), 3'000, 9'000).flashes, 3) << "as when nothing was pressed";
}

TEST(Lamp, PassAdvise_IsTwoLongOnesOnce) {
  LightPlayer player;
  const Seen seen = watch(player, after(Result::kPassAdvise), 0, duration_ns({Light::kTwoLong, 0}) / kMs);
  EXPECT_EQ(seen.flashes, 2);
  EXPECT_GT(seen.longest_ms, 500);
  EXPECT_LT(watch(player, after(Result::kPassAdvise), 6'000, 9'000).longest_ms, 400);
}

TEST(Lamp, FailRetry_CountsTheTroublesNumber) {
  for (int number = 1; number <= static_cast<int>(Trouble::kDevice); ++number)
    EXPECT_EQ(flashes_in_a_row(after(Result::kFailRetry, static_cast<Trouble>(number))), number);
}

TEST(Lamp, FailService_BeginsWithALongOne) {
  for (int number = 1; number <= static_cast<int>(Trouble::kDevice); ++number) {
    const LightInput input = after(Result::kFailService, static_cast<Trouble>(number));
    EXPECT_EQ(choose_light(input).light, Light::kLongThenBlinks);
    EXPECT_GT(watch(input, 8'000).longest_ms, 500) << number;
    EXPECT_LT(watch(after(Result::kFailRetry, static_cast<Trouble>(number)), 8'000).longest_ms, 400) << number;
  }
}

TEST(Lamp, NewPattern_BeginsAtItsBeginning) {
  LightPlayer player;
  watch(player, calibrated(), 0, 2'345);
  EXPECT_TRUE(player.lit(in_state(State::kGrab), 2'345 * kMs));
  EXPECT_EQ(player.pattern(), (LightPattern{Light::kBlinks, 1}));
}

TEST(Lamp, PassTwice_ShowsTwice) {
  LightPlayer player;
  watch(player, after(Result::kPass), 0, 5'000);
  watch(player, in_state(State::kGrab), 5'000, 500);
  EXPECT_EQ(watch(player, after(Result::kPass), 5'500, 3'000).longest_ms, 3'000);
}

// Nothing that the grammar can say lights the lamp for ever or leaves it dark for ever: both look like a dead device.
TEST(Lamp, EveryPatternWithoutAHand_Blinks) {
  std::vector<LightInput> inputs = {calibrated()};
  for (int i = 0; i <= static_cast<int>(State::kCheck); ++i) inputs.push_back(in_state(static_cast<State>(i)));
  for (const Result result : {Result::kPass, Result::kPassAdvise, Result::kFailRetry, Result::kFailService})
    for (int number = 1; number <= 7; ++number) inputs.push_back(after(result, static_cast<Trouble>(number)));
  for (const LightInput& input : inputs) {
    const Seen seen = watch(input, 30'000);
    EXPECT_GE(seen.flashes, 8);
    EXPECT_LT(seen.lit_ms, 20'000);
    EXPECT_GT(seen.last_lit_ms, 20'000);
  }
}

}  // namespace
}  // namespace roomcal::face
