#include "drivers/image/recovery.h"

#include <random>
#include <set>
#include <string>

#include <gtest/gtest.h>

namespace roomcal::drivers {
namespace {

using ports::ImageFault;
using ports::SourceState;

constexpr int64_t kMs = 1'000'000, kS = 1'000'000'000;

// A ladder with its clock; somebody waits all the time unless a test says otherwise.
struct Ladder {
  explicit Ladder(const RecoveryOptions& options = {}) : recovery(options) {
    recovery.start(now);
    recovery.resume(now);
    recovery.begun(now);
  }
  void image(int64_t after = 33 * kMs) { recovery.image(now += after); }
  void fault(ImageFault fault) { recovery.fault(fault, now); }
  RecoveryStep step() const { return recovery.order(now).step; }
  int64_t until() const { return recovery.order(now).until_ns; }
  // Images for that long.
  void stream(int64_t for_ns) {
    for (const int64_t end = now + for_ns; now < end;) image(100 * kMs);
  }

  Recovery recovery;
  int64_t now = 1000 * kS;
};

TEST(Recovery, NotStarted_OrdersNothing) {
  Recovery recovery;
  EXPECT_EQ(recovery.state(), SourceState::kClosed);
  EXPECT_EQ(recovery.order(5).step, RecoveryStep::kGiveUp);
  recovery.fault(ImageFault::kGone, 5);
  recovery.image(6);
  EXPECT_EQ(recovery.state(), SourceState::kClosed);
}

TEST(Recovery, ImagesComing_WatchesForTheNextOne) {
  Ladder ladder;
  EXPECT_EQ(ladder.recovery.state(), SourceState::kStreaming);
  EXPECT_EQ(ladder.until(), ladder.now + 3 * kS);
  ladder.image();
  EXPECT_EQ(ladder.step(), RecoveryStep::kWatch);
  EXPECT_EQ(ladder.until(), ladder.now + 500 * kMs);
  EXPECT_FALSE(ladder.recovery.stalled(ladder.until() - 1));
  EXPECT_TRUE(ladder.recovery.stalled(ladder.until()));
}

TEST(Recovery, StallAfterStall_WalksTheWholeLadderThenGivesUp) {
  Ladder ladder({.may_reset_port = true});
  ladder.image();
  const auto stall = [&] {
    ladder.now = ladder.until();
    ASSERT_TRUE(ladder.recovery.stalled(ladder.now));
    ladder.fault(ImageFault::kStall);
    EXPECT_EQ(ladder.recovery.state(),
              ladder.step() == RecoveryStep::kGiveUp ? SourceState::kFaulted : SourceState::kRecovering);
  };
  for (int i = 0; i < 2; ++i) {
    stall();
    EXPECT_EQ(ladder.step(), RecoveryStep::kRestartStream);
    ladder.recovery.begun(ladder.now);
  }
  stall();
  EXPECT_EQ(ladder.step(), RecoveryStep::kReopen);
  ladder.recovery.begun(ladder.now);
  stall();
  EXPECT_EQ(ladder.step(), RecoveryStep::kStayClosed);  // the second time it is given a rest
  EXPECT_EQ(ladder.until(), ladder.now + kS);
  ladder.now = ladder.until();
  EXPECT_EQ(ladder.step(), RecoveryStep::kReopen);
  ladder.recovery.begun(ladder.now);
  stall();
  EXPECT_EQ(ladder.step(), RecoveryStep::kResetPort);
  ladder.recovery.port_reset(ladder.now);
  EXPECT_EQ(ladder.step(), RecoveryStep::kStayClosed);
  ladder.now = ladder.until();
  EXPECT_EQ(ladder.step(), RecoveryStep::kReopen);
  ladder.recovery.begun(ladder.now);
  stall();
  EXPECT_EQ(ladder.step(), RecoveryStep::kGiveUp);
  ladder.recovery.begun(ladder.now);
  ladder.image();
  EXPECT_EQ(ladder.recovery.state(), SourceState::kFaulted);
  ladder.recovery.start(ladder.now);
  EXPECT_EQ(ladder.step(), RecoveryStep::kReopen);
}

TEST(Recovery, PortNotToBeReset_GivesUpOneRungEarlier) {
  Ladder ladder;
  int reopens = 0;
  for (int i = 0; i < 10 && ladder.recovery.state() != SourceState::kFaulted; ++i) {
    ladder.fault(ImageFault::kStale);
    EXPECT_NE(ladder.step(), RecoveryStep::kResetPort);
    ladder.now += 2 * kS;
    if (ladder.step() == RecoveryStep::kReopen) ++reopens;
    ladder.recovery.begun(ladder.now);
  }
  EXPECT_EQ(reopens, 2);
  EXPECT_EQ(ladder.recovery.state(), SourceState::kFaulted);
}

TEST(Recovery, DamagedImages_RestartOnlyThreeInARow) {
  Ladder ladder;
  for (int i = 0; i < 100; ++i) {
    ladder.fault(ImageFault::kMarkedDamaged);
    ladder.fault(ImageFault::kShort);
    EXPECT_EQ(ladder.step(), RecoveryStep::kWatch);
    ladder.image();
  }
  EXPECT_EQ(ladder.recovery.state(), SourceState::kStreaming);
  ladder.fault(ImageFault::kTransient);
  ladder.fault(ImageFault::kUndecodable);
  ladder.fault(ImageFault::kShort);
  EXPECT_EQ(ladder.step(), RecoveryStep::kRestartStream);
}

TEST(Recovery, DamagedImages_AreNoStall) {
  Ladder ladder({.damaged_in_a_row = 1000});
  for (int i = 0; i < 100; ++i) {
    ladder.now += 100 * kMs;
    EXPECT_FALSE(ladder.recovery.stalled(ladder.now));
    ladder.fault(ImageFault::kShort);
  }
}

TEST(Recovery, StampFaults_OrderNothing) {
  Ladder ladder;
  ladder.image();
  for (int i = static_cast<int>(ImageFault::kStampFuture); i <= static_cast<int>(ImageFault::kStampUnknown); ++i)
    for (int n = 0; n < 10; ++n) ladder.fault(static_cast<ImageFault>(i));
  EXPECT_EQ(ladder.step(), RecoveryStep::kWatch);
  EXPECT_EQ(ladder.recovery.state(), SourceState::kStreaming);
}

TEST(Recovery, CameraUnplugged_IsLookedForForEverWithGrowingWaits) {
  Ladder ladder;
  ladder.image();
  ladder.fault(ImageFault::kGone);
  int64_t expected = kS;
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(ladder.step(), RecoveryStep::kStayClosed);
    EXPECT_EQ(ladder.until(), ladder.now + expected) << i;
    ladder.now = ladder.until();
    EXPECT_EQ(ladder.step(), RecoveryStep::kReopen);
    ladder.fault(i % 2 == 0 ? ImageFault::kNotFound : ImageFault::kBusy);
    expected = std::min(2 * expected, 30 * kS);
  }
  ladder.now = ladder.until();
  ladder.recovery.begun(ladder.now);
  EXPECT_EQ(ladder.recovery.state(), SourceState::kRecovering);
  ladder.image();
  EXPECT_EQ(ladder.recovery.state(), SourceState::kStreaming);
  ladder.fault(ImageFault::kGone);
  EXPECT_EQ(ladder.until(), ladder.now + kS);  // the waits begin anew
}

TEST(Recovery, WrongFormat_GivesUpAtOnce) {
  Ladder ladder;
  ladder.fault(ImageFault::kFormat);
  EXPECT_EQ(ladder.step(), RecoveryStep::kGiveUp);
}

TEST(Recovery, StreamThatCannotBeRestarted_IsReopened) {
  Ladder ladder;
  ladder.fault(ImageFault::kEndOfStream);
  ASSERT_EQ(ladder.step(), RecoveryStep::kRestartStream);
  ladder.fault(ImageFault::kTransient);
  EXPECT_EQ(ladder.step(), RecoveryStep::kReopen);
}

TEST(Recovery, HealthySpell_FillsTheBudget) {
  for (const bool long_enough : {false, true}) {
    Ladder ladder;
    for (int i = 0; i < 2; ++i) {
      ladder.fault(ImageFault::kUnknownBuffer);
      ASSERT_EQ(ladder.step(), RecoveryStep::kRestartStream);
      ladder.recovery.begun(ladder.now);
      ladder.image();
    }
    ladder.stream(long_enough ? 31 * kS : 29 * kS);
    ladder.fault(ImageFault::kUnknownBuffer);
    EXPECT_EQ(ladder.step(), long_enough ? RecoveryStep::kRestartStream : RecoveryStep::kReopen);
  }
}

TEST(Recovery, PluggedInAgain_FillsTheBudgetButSomebodyElsesUseDoesNot) {
  for (const ImageFault absence : {ImageFault::kGone, ImageFault::kBusy}) {
    Ladder ladder;
    for (int i = 0; i < 2; ++i) {
      ladder.fault(ImageFault::kStall);
      ladder.recovery.begun(ladder.now);
    }
    ladder.fault(absence);
    ladder.now = ladder.until();
    ladder.recovery.begun(ladder.now);
    ladder.image();
    ladder.fault(ImageFault::kStall);
    EXPECT_EQ(ladder.step(), absence == ImageFault::kGone ? RecoveryStep::kRestartStream : RecoveryStep::kReopen);
  }
}

TEST(Recovery, NobodyWaiting_IsNoStall) {
  Ladder ladder;
  ladder.image();
  ladder.now += 400 * kMs;
  ladder.recovery.pause(ladder.now);
  ladder.now += 100 * kS;
  EXPECT_FALSE(ladder.recovery.stalled(ladder.now));
  ladder.recovery.resume(ladder.now);
  EXPECT_EQ(ladder.until(), ladder.now + 100 * kMs);
}

TEST(Recovery, ShortWaitsInARow_AddUpToAStall) {
  Ladder ladder;
  ladder.image();
  int waits = 0;
  for (; waits < 1000 && !ladder.recovery.stalled(ladder.now); ++waits) {
    ladder.recovery.pause(ladder.now);
    ladder.now += 7 * kS;
    ladder.recovery.resume(ladder.now);
    ladder.now += 10 * kMs;
  }
  EXPECT_EQ(waits, 50);
}

TEST(Recovery, NothingComesAfterStart_FirstImagesPatienceIsOfWaitingOnly) {
  Recovery recovery;
  recovery.start(0);
  recovery.begun(8 * kS);  // opening took its time
  recovery.resume(20 * kS);
  EXPECT_EQ(recovery.order(20 * kS).until_ns, 23 * kS);
}

// Whatever happens in whatever order: never more steps than the budget without a healthy spell, never an order to
// wait into the past, and given up only for a reason.
TEST(Recovery, RandomTroubleWithoutAbsence_EndsWithinItsBudget) {
  for (uint32_t seed = 1; seed <= 200; ++seed) {
    std::mt19937 random(seed);
    Ladder ladder({.may_reset_port = true});
    int restarts = 0, reopens = 0, resets = 0;
    const auto absent = [](ImageFault f) {
      return f == ImageFault::kGone || f == ImageFault::kNotFound || f == ImageFault::kBusy ||
             f == ImageFault::kDenied || f == ImageFault::kFormat;
    };
    for (int i = 0; i < 1000 && ladder.recovery.state() != SourceState::kFaulted; ++i) {
      const auto fault = static_cast<ImageFault>(random() % ports::kImageFaults);
      if (!absent(fault)) ladder.fault(fault);
      switch (ladder.step()) {
        case RecoveryStep::kStayClosed:
          ASSERT_GT(ladder.until(), ladder.now);
          ladder.now = ladder.until();
          break;
        case RecoveryStep::kRestartStream:
          ++restarts;
          ladder.recovery.begun(ladder.now);
          break;
        case RecoveryStep::kReopen:
          ++reopens;
          ladder.recovery.begun(ladder.now);
          break;
        case RecoveryStep::kResetPort:
          ++resets;
          ladder.recovery.port_reset(ladder.now);
          break;
        default:
          break;
      }
      if (random() % 4 == 0) ladder.image(10 * kMs);
    }
    EXPECT_EQ(ladder.recovery.state(), SourceState::kFaulted) << seed;
    EXPECT_LE(restarts, 2) << seed;
    EXPECT_LE(reopens, 3) << seed;  // one of them after the port's reset
    EXPECT_EQ(resets, 1) << seed;
  }
}

TEST(RecoveryStep, EveryOne_HasItsOwnName) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(RecoveryStep::kGiveUp); ++i)
    names.insert(to_string(static_cast<RecoveryStep>(i)));
  EXPECT_EQ(names.size(), 6U);
  EXPECT_EQ(names.count("unknown"), 0U);
}

}  // namespace
}  // namespace roomcal::drivers
