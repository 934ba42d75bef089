// The table of button_grammar.h, row by row.
#include "runtime/face/button_grammar.h"

#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace roomcal::face {
namespace {

constexpr int64_t kMs = 1'000'000;
constexpr int64_t kTick_ns = 10 * kMs;

/// A person, and the loop that asks a hundred times a second.
class ButtonTest : public testing::Test {
 protected:
  using Gestures = std::vector<Gesture>;

  void edge(bool down) { note(grammar_.on_edge({down, now_ns_}, running_)); }
  void wait(int64_t ms) {
    for (const int64_t until_ns = now_ns_ + ms * kMs; now_ns_ < until_ns;) {
      now_ns_ += kTick_ns;
      note(grammar_.tick(now_ns_));
    }
  }
  void press(int64_t ms) {
    edge(true);
    wait(ms);
    edge(false);
  }
  /// What was meant since the last call.
  Gestures meant() { return std::exchange(meant_, {}); }
  Hold hold() const { return grammar_.hold(now_ns_); }

  ButtonGrammar grammar_;
  bool running_ = false;
  int64_t now_ns_ = 5'000 * kMs;

 private:
  void note(Gesture gesture) {
    if (gesture != Gesture::kNone) meant_.push_back(gesture);
  }
  Gestures meant_;
};

TEST_F(ButtonTest, Idle_LengthOfThePressDecides) {
  press(200);
  EXPECT_EQ(meant(), Gestures{Gesture::kVerify});
  press(990);
  EXPECT_EQ(meant(), Gestures{Gesture::kVerify});
  for (const int64_t undecided_ms : {1'000, 2'000, 2'990}) {
    press(undecided_ms);
    EXPECT_EQ(meant(), Gestures{}) << undecided_ms;
  }
  for (const int64_t long_ms : {3'000, 5'000, 9'980}) {
    press(long_ms);
    EXPECT_EQ(meant(), Gestures{Gesture::kCalibrate}) << long_ms;
  }
}

TEST_F(ButtonTest, NothingStarts_WhileItIsDown) {
  edge(true);
  wait(9'000);
  EXPECT_EQ(meant(), Gestures{});
}

TEST_F(ButtonTest, TenSeconds_OfferAndAShortPressTakesIt) {
  edge(true);
  wait(9'990);
  EXPECT_FALSE(grammar_.offered());
  wait(20);
  EXPECT_EQ(meant(), Gestures{Gesture::kOffer});
  EXPECT_TRUE(grammar_.offered());
  edge(false);
  wait(5'000);
  EXPECT_EQ(meant(), Gestures{}) << "letting go is not the press";
  press(300);
  EXPECT_EQ(meant(), Gestures{Gesture::kRestore});
  EXPECT_FALSE(grammar_.offered());
  press(300);
  EXPECT_EQ(meant(), Gestures{Gesture::kVerify}) << "an offer is taken once";
}

TEST_F(ButtonTest, OfferNotTaken_Lapses) {
  press(10'100);
  EXPECT_EQ(meant(), Gestures{Gesture::kOffer});
  wait(10'100);
  EXPECT_FALSE(grammar_.offered());
  press(300);
  EXPECT_EQ(meant(), Gestures{Gesture::kVerify});
}

TEST_F(ButtonTest, LongerPressOnAnOffer_MeansNo) {
  for (const int64_t ms : {1'500, 4'000, 10'500}) {
    press(10'100);
    EXPECT_EQ(meant(), Gestures{Gesture::kOffer});
    press(ms);
    EXPECT_EQ(meant(), Gestures{}) << ms;
    EXPECT_FALSE(grammar_.offered()) << ms;
  }
}

// The loop was away while the button was held.
TEST_F(ButtonTest, EdgesWithoutTicksBetween_MeanTheSame) {
  edge(true);
  now_ns_ += 12'000 * kMs;
  edge(false);
  EXPECT_EQ(meant(), Gestures{Gesture::kOffer});
  now_ns_ += 500 * kMs;
  edge(true);
  now_ns_ += 500 * kMs;
  edge(false);
  EXPECT_EQ(meant(), Gestures{Gesture::kRestore});
}

TEST_F(ButtonTest, DownDuringARun_AbortsAtOnceAndNothingElse) {
  running_ = true;
  edge(true);
  EXPECT_EQ(meant(), Gestures{Gesture::kAbort});
  running_ = false;  // it has ended
  wait(4'000);
  edge(false);
  EXPECT_EQ(meant(), Gestures{}) << "the same press must not start a calibration";
  press(100);
  EXPECT_EQ(meant(), Gestures{Gesture::kVerify});
}

TEST_F(ButtonTest, RunThatBeginsWhileHeld_IsNotAborted) {
  edge(true);
  wait(500);
  running_ = true;
  edge(false);
  EXPECT_EQ(meant(), Gestures{Gesture::kVerify});
}

TEST_F(ButtonTest, HeldForAMinute_IsStuckUntilReleased) {
  edge(true);
  wait(59'900);
  EXPECT_EQ(meant(), Gestures{Gesture::kOffer});
  wait(200);
  EXPECT_TRUE(grammar_.stuck());
  EXPECT_FALSE(grammar_.offered());
  EXPECT_EQ(hold(), Hold::kUp) << "the lamp goes on with what matters";
  wait(100'000);
  edge(false);
  EXPECT_EQ(meant(), Gestures{});
  EXPECT_FALSE(grammar_.stuck());
  press(200);
  EXPECT_EQ(meant(), Gestures{Gesture::kVerify});
}

TEST_F(ButtonTest, RepeatedEdges_AreOne) {
  edge(false);
  edge(true);
  wait(2'000);
  edge(true);  // lost its release, or a state that was read twice
  wait(1'500);
  edge(false);
  edge(false);
  EXPECT_EQ(meant(), Gestures{Gesture::kCalibrate});
}

TEST_F(ButtonTest, Hold_TellsTheLampHowFarItIs) {
  EXPECT_EQ(hold(), Hold::kUp);
  edge(true);
  EXPECT_EQ(hold(), Hold::kShort);
  wait(1'000);
  EXPECT_EQ(hold(), Hold::kNothing);
  wait(2'000);
  EXPECT_EQ(hold(), Hold::kCalibrate);
  wait(7'000);
  EXPECT_EQ(hold(), Hold::kOffer);
  edge(false);
  EXPECT_EQ(hold(), Hold::kUp);
  running_ = true;
  edge(true);
  EXPECT_EQ(hold(), Hold::kUp) << "this press has had its effect";
}

TEST_F(ButtonTest, HeldFor_CountsFromTheEdge) {
  EXPECT_FALSE(grammar_.held_for(0, now_ns_));
  edge(true);
  wait(1'000);
  EXPECT_TRUE(grammar_.held_for(1'000 * kMs, now_ns_));
  EXPECT_FALSE(grammar_.held_for(1'001 * kMs, now_ns_));
}

TEST(GestureNames, EachHasItsOwn) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(Gesture::kRestore); ++i) names.insert(to_string(static_cast<Gesture>(i)));
  EXPECT_EQ(names.size(), 6U);
  EXPECT_STREQ(to_string(static_cast<Gesture>(99)), "unknown");
}

}  // namespace
}  // namespace roomcal::face
